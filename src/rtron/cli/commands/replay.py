"""`rtron replay`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import Output, PlanOption, TextOrJson
from rtron.cli.support.outcome import STDOUT, Outcome, as_json, log_errors
from rtron.cli.support.progress import show_count
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
    from rtron.workflows.replay import replay_bag  # noqa: PLC0415 - no other command needs it

    log_errors()
    with show_count("messages") as update:
        found = replay_bag(bag, plan, update)
    if format is TextOrJson.JSON:
        return Outcome(as_json(replay_to_json(found)), to=output)
    return Outcome(replay_text(str(bag), found), to=output)
