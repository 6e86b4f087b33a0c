"""`rtron replay`."""

import logging
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.options import Output, PlanOption, TextOrJson
from rtron.cli.outcome import STDOUT, Outcome, as_json
from rtron.cli.progress import counting
from rtron.planning.read import read_plan
from rtron.reports.plan.replay import replay_text, replay_to_json


def replay(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="A .bag, .mcap, .db3, or a folder.")],
    *,
    plan: PlanOption,
    format: Annotated[TextOrJson, typer.Option(help="A report, or JSON.")] = TextOrJson.TEXT,
    output: Output = STDOUT,
) -> Outcome:
    """Play a recording through the plan: what would have passed, and what not.

    The same policies decide as in the running guard, with the recording's
    clock. Nothing is published. Try a plan on what the robot did yesterday
    before it guards the robot today.

    $ rtron replay run.bag --plan rtron.yaml
    $ rtron replay run.mcap --plan rtron.yaml --format json -o replay.json

    A recording of ROS 2 does not tell who published. Where the plan has one
    publisher for a topic, it is taken for that; else for unapproved. Goals of
    actions are there if service introspection was recorded; see docs/actions.md.

    Exit code: 0 played, 2 bad input.
    """
    from rtron.cli.recording import Recording  # noqa: PLC0415 - no other command needs it
    from rtron.guard.replay import Player  # noqa: PLC0415 - likewise

    logging.basicConfig(level=logging.ERROR, format="%(levelname)s %(message)s")
    recording = Recording(bag)
    wanted = read_plan(plan, recording.definitions)
    with counting("messages") as tell:
        found = Player(wanted).play(recording.messages(wanted.ros), tell)
    if format is TextOrJson.JSON:
        return Outcome(as_json(replay_to_json(found)), to=output)
    return Outcome(replay_text(str(bag), found), to=output)
