"""`rtron replay`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import Output, PlanOption, TextOrJson
from rtron.cli.support.outcome import STDOUT, Outcome, as_json, log_errors
from rtron.cli.support.progress import show_count


def replay(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="A .bag, .mcap, .db3, or a folder.")],
    *,
    plan: PlanOption,
    format: Annotated[TextOrJson, typer.Option(help="A report, or JSON.")] = TextOrJson.TEXT,
    output: Output = STDOUT,
) -> Outcome:
    """Play a recording through a plan: which messages pass, and which do not.

    The policies of the running guard decide, with the clock of the recording.
    Nothing is published.

    $ rtron replay run.bag --plan rtron.yaml
    $ rtron replay run.mcap --plan rtron.yaml --format json -o replay.json

    A ROS 2 recording does not name publishers. If the plan has one publisher
    for a topic, a message counts as from it, else as unapproved. Goals of
    actions need recorded service introspection; see docs/actions.md.

    Exit code: 0 played, 2 bad input.
    """
    from rtron.reports.plan.replay import replay_text, replay_to_json
    from rtron.workflows.replay import replay_bag

    log_errors()
    with show_count("messages") as update:
        found = replay_bag(bag, plan, update)
    if format is TextOrJson.JSON:
        return Outcome(as_json(replay_to_json(found)), to=output)
    return Outcome(replay_text(str(bag), found), to=output)
