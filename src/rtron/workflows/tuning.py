"""`rtron plan --from-run`: a plan, and a run that was measured under it."""

import logging
import os
from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import STDOUT, Outcome, as_json, replace_file
from rtron.cli.support.progress import show_count
from rtron.errors import InputError
from rtron.planning.plan_file.loader import read_plan
from rtron.planning.tuning import tune_plan, tuned_yaml
from rtron.reports.plan.tuning import tuning_text, tuning_to_json
from rtron.sources.bag.file_type import is_bag
from rtron.sources.run_json import read_run, run_to_json
from rtron.vocabulary import MeasuredRun, Plan

TUNED_FILE = "tuned.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningRequest:
    """What the command line says: the run, its plan, and what to write and print."""

    run: Path
    plan: Path | None
    output: Path | None
    format: TextOrJson


def tune_from_run(request: TuningRequest) -> Outcome:
    """Return what the run proposes for its plan; write the plan if there is an `output`."""
    if request.plan is None:
        help = "add --plan rtron.yaml, the plan that the run was measured under"
        raise InputError("--from-run without --plan", help=help)
    if request.output == STDOUT and request.format is TextOrJson.JSON:
        help = "leave one of the two out, or give -o a file"
        raise InputError("both the plan and its figures would be printed", help=help)
    plan, run, notes = _read_run(request.run, request.plan)
    tuned_plan, proposals = tune_plan(plan, run)
    yaml = tuned_yaml(tuned_plan, proposals)
    if request.output == STDOUT:
        return Outcome(yaml)
    if request.output:
        replace_file(request.output, yaml)
    if request.format is TextOrJson.JSON:
        return Outcome(as_json(tuning_to_json(run, proposals)))
    title, next_step = str(request.run), _next_step(request)
    return Outcome(tuning_text(title, run, proposals, notes, next_step))


def _read_run(path: Path, plan: Path) -> tuple[Plan, MeasuredRun, tuple[str, ...]]:
    """Return the plan, the figures in a file, or of a bag that is played through it, and notes."""
    if is_bag(path):
        return _replay_run(path, plan)
    return read_plan(plan), read_run(path), ()


def _replay_run(bag: Path, plan: Path) -> tuple[Plan, MeasuredRun, tuple[str, ...]]:
    from rtron.guard.replay.player import RecordingPlayer  # noqa: PLC0415 - likewise
    from rtron.workflows.replay import GuardRecording  # noqa: PLC0415 - only what is read is loaded

    logging.basicConfig(level=logging.ERROR, format="%(levelname)s %(message)s")
    recording = GuardRecording(bag)
    guard_plan = read_plan(plan, recording.definitions)
    player = RecordingPlayer(guard_plan, measured=True)
    with show_count("messages") as update:
        found = player.play(recording.messages(guard_plan.ros), update)
    return guard_plan, player.figures(), found.notes


def _next_step(request: TuningRequest) -> str:
    if request.output:
        return f"rtron check {quote(str(request.output))}"
    command = ("rtron", "plan", "--from-run", request.run, "--plan", request.plan, "-o", TUNED_FILE)
    return " ".join(quote(str(part)) for part in command)


@dataclass(frozen=True, slots=True)
class RunFileWriter:
    """Writes runs to a file, each in place of the one before; goes to the guard's own process."""

    path: Path

    def __call__(self, run: MeasuredRun) -> None:
        """Write a run; InputError if that is not possible."""
        temporary = self.path.with_name(f".{self.path.name}.{os.getpid()}")
        try:
            temporary.unlink(missing_ok=True)
            with temporary.open("x", encoding="utf-8") as file:
                file.write(as_json(run_to_json(run)))
            temporary.replace(self.path)
        except OSError as error:
            reason = error.strerror or "cannot be written"
            raise InputError(reason, path=str(self.path), help="choose another file") from None
        finally:
            _remove(temporary)


def _remove(path: Path) -> None:
    """Remove what a failed write has left."""
    try:
        path.unlink(missing_ok=True)
    except OSError:
        return
