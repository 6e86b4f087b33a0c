"""`rtron plan --from-run`: a plan, and a run that was measured under it."""

import logging
from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from rtron.cli.options import TextOrJson
from rtron.cli.outcome import STDOUT, Outcome, as_json, replace_file
from rtron.cli.progress import counting
from rtron.errors import InputError
from rtron.planning.read import read_plan
from rtron.planning.tune import tune, tuned_yaml
from rtron.reports.plan.tuning import tuning_text, tuning_to_json
from rtron.sources.bag.kind import is_bag
from rtron.sources.run_json import read_run
from rtron.vocabulary import Plan, Run

TUNED = "tuned.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class Tuning:
    """What the command line says: the run, its plan, and what to write and print."""

    run: Path
    plan: Path | None
    output: Path | None
    format: TextOrJson


def tuned(chosen: Tuning) -> Outcome:
    """Return what the run proposes for its plan; write the plan if there is an `output`."""
    if chosen.plan is None:
        help = "add --plan rtron.yaml, the plan that the run was measured under"
        raise InputError("--from-run without --plan", help=help)
    if chosen.output == STDOUT and chosen.format is TextOrJson.JSON:
        help = "leave one of the two out, or give -o a file"
        raise InputError("both the plan and its figures would be printed", help=help)
    plan, run, notes = _run(chosen.run, chosen.plan)
    made, proposals = tune(plan, run)
    yaml = tuned_yaml(made, proposals)
    if chosen.output == STDOUT:
        return Outcome(yaml)
    if chosen.output:
        replace_file(chosen.output, yaml)
    if chosen.format is TextOrJson.JSON:
        return Outcome(as_json(tuning_to_json(run, proposals)))
    title, next_step = str(chosen.run), _next_step(chosen)
    return Outcome(tuning_text(title, run, proposals, notes, next_step))


def _run(path: Path, plan: Path) -> tuple[Plan, Run, tuple[str, ...]]:
    """Return the plan, the figures in a file, or of a bag that is played through it, and notes."""
    if is_bag(path):
        return _recorded(path, plan)
    return read_plan(plan), read_run(path), ()


def _recorded(bag: Path, plan: Path) -> tuple[Plan, Run, tuple[str, ...]]:
    from rtron.cli.recording import Recording  # noqa: PLC0415 - only what is read is loaded
    from rtron.guard.replay import Player  # noqa: PLC0415 - likewise

    logging.basicConfig(level=logging.ERROR, format="%(levelname)s %(message)s")
    recording = Recording(bag)
    wanted = read_plan(plan, recording.definitions)
    player = Player(wanted, measured=True)
    with counting("messages") as tell:
        found = player.play(recording.messages(wanted.ros), tell)
    return wanted, player.figures(), found.notes


def _next_step(chosen: Tuning) -> str:
    if chosen.output:
        return f"rtron check {quote(str(chosen.output))}"
    words = ("rtron", "plan", "--from-run", chosen.run, "--plan", chosen.plan, "-o", TUNED)
    return " ".join(quote(str(word)) for word in words)
