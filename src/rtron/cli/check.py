"""`rtron check`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.outcome import FOUND, OK, Outcome
from rtron.cli.remarks import remarks_of
from rtron.planning.check import check_plan
from rtron.planning.problem import Level
from rtron.planning.read import read_plan
from rtron.reports.plan.problems import problems_text
from rtron.sources.graph_json import read_graph


def check(
    plan: Annotated[Path, typer.Argument(metavar="rtron.yaml", help="The plan.")],
    *,
    graph: Annotated[
        Path | None,
        typer.Option(metavar="GRAPH.json", help="Compare the plan with this app, too."),
    ] = None,
) -> Outcome:
    """Check a plan that you edited, before a robot trusts it.

    Every fault is told with its line and the nearest valid word. With the
    app's graph, topics and flows that nobody publishes are found, too.

    $ rtron check rtron.yaml
    $ rtron check rtron.yaml --graph graph.json

    Exit code: 0 good, 1 it does not fit the app, 2 it cannot be read.
    """
    wanted = read_plan(plan)
    problems = check_plan(wanted, read_graph(graph) if graph else None)
    failed = any(problem.level is Level.ERROR for problem in problems)
    return Outcome(problems_text(str(plan), remarks_of(problems)), FOUND if failed else OK)
