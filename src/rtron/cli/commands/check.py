"""`rtron check`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.outcome import FINDINGS, OK, Outcome


def check(
    plan: Annotated[Path, typer.Argument(metavar="rtron.yaml", help="The plan.")],
    *,
    graph: Annotated[
        Path | None,
        typer.Option(metavar="GRAPH.json", help="Also compare the plan with this app."),
    ] = None,
) -> Outcome:
    """Check a plan that you edited.

    Each error comes with its line and the nearest valid word. It warns of
    values that leave a policy without effect. With the app's graph, it also
    finds topics and flows that nobody publishes, and orders that are a guess.

    $ rtron check rtron.yaml
    $ rtron check rtron.yaml --graph graph.json

    Exit code: 0 good, 1 it does not fit the app, 2 it cannot be read.
    """
    from rtron.planning.plan_file.loader import read_plan
    from rtron.planning.problem import ProblemLevel
    from rtron.reports.plan.problems import problems_text
    from rtron.sources.graph_json import read_graph
    from rtron.workflows.check_plan import check as check_plan

    checked_plan = read_plan(plan)
    problems = check_plan(checked_plan, read_graph(graph) if graph else None)
    failed = any(problem.level is ProblemLevel.ERROR for problem in problems)
    return Outcome(problems_text(str(plan), problems), FINDINGS if failed else OK)
