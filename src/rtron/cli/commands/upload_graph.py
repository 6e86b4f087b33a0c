"""`rtron upload-graph`."""

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.outcome import Outcome
from rtron.cli.support.service_options import (
    DEFAULT_SERVICE,
    CaOption,
    RobotOption,
    ServiceOption,
    TokenOption,
    connect_to_service,
)

_LONGEST = 16 << 20


def upload_graph(
    graph: Annotated[
        Path,
        typer.Argument(metavar="GRAPH.json", help="The interaction graph; - is standard input."),
    ],
    *,
    service: ServiceOption = DEFAULT_SERVICE,
    token_file: TokenOption = None,
    robot: RobotOption = "",
    ca: CaOption = None,
) -> Outcome:
    """Upload the interaction graph of a robot's app for the console.

    Without it the console draws only the nodes of the plan. The service finds
    the risks of the graph. Needs the role developer.

    $ rtron scan src --launch pkg/app.launch --format graph -o graph.json
    $ rtron upload-graph graph.json --robot car1 --token-file me.token

    Exit code: 0 stored, 2 rejected.
    """
    from rtron.reports.text_layout import counted
    from rtron.sources.bounded_file import read_bounded

    client = connect_to_service(service, token_file, ca)
    data = read_bounded(graph, _LONGEST)
    name = client.resolve_robot(robot)
    risks = client.put("robots", name, "graph", data=data)["risks"]
    kinds = Counter(risk["kind"] for risk in risks)
    kind_counts = ", ".join(f"{number} {kind}" for kind, number in sorted(kinds.items()))
    summary = f"{counted(len(risks), 'risk')}{f': {kind_counts}' if kind_counts else ''}"
    return Outcome(f"{name} has the graph; {summary}\n")
