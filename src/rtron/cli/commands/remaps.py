"""`rtron remaps`."""

from typing import Annotated

import typer

from rtron.cli.support.options import PlanOption, TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json


def remaps(
    node: Annotated[
        str, typer.Argument(metavar="[NODE]", help="Only this node's.", show_default=False)
    ] = "",
    *,
    plan: PlanOption,
    format: Annotated[TextOrJson, typer.Option(help="A report, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """List the remaps that put the guard between the nodes of a plan.

    `rtron instrument` writes them into a launch file. This lists them for nodes
    that start in another way: by hand, from a script, a service or a container.

    $ rtron remaps --plan rtron.yaml
    $ rtron remaps /nav --plan rtron.yaml
    $ rtron remaps --plan rtron.yaml --format json | jq '.nodes[].arguments'

    It reads the plan alone: whether a node has remaps of its own, it cannot see.
    `rtron verify --live` shows later whether all of them are in force.

    Exit code: 0 listed, 1 the plan enforces nothing, 2 bad plan or node.
    """
    from rtron.planning.instrument.common.remaps import planned_remaps
    from rtron.planning.plan_file.loader import read_plan
    from rtron.reports.plan.remaps import remaps_text, remaps_to_json

    read = read_plan(plan)
    listed = planned_remaps(read, node)
    report = (
        as_json(remaps_to_json(read.ros, listed))
        if format is TextOrJson.JSON
        else remaps_text(str(plan), read.ros, listed)
    )
    return Outcome(report, OK if listed else FINDINGS)
