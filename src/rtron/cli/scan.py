"""`rtron scan`."""

from enum import Enum
from typing import Annotated

import typer

from rtron.cli.app import App, chosen_app
from rtron.cli.options import (
    DEFAULT_MASTER,
    DEFAULT_TIMEOUT,
    GraphPath,
    Lists,
    Live,
    Master,
    Output,
    Timeout,
)
from rtron.cli.outcome import FOUND, OK, STDOUT, Outcome, as_json
from rtron.reports.dot import graph_to_dot
from rtron.reports.lines import Report
from rtron.reports.risks_json import risks_to_json
from rtron.reports.text import Scan, scan_text
from rtron.risks import discover, load_lists
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import InteractionGraph, RiskReport, Severity


class Format(str, Enum):
    """What a scan gives: a report, the risks, the graph, or the graph as a picture."""

    TEXT = "text"
    JSON = "json"
    GRAPH = "graph"
    DOT = "dot"


class FailOn(str, Enum):
    """The mildest severity that a scan does not let pass."""

    LOW = "low"
    MEDIUM = "medium"
    HIGH = "high"
    NEVER = "never"


def scan(  # noqa: PLR0913 - one for each option
    graph: GraphPath = None,
    *,
    live: Live = False,
    master: Master = DEFAULT_MASTER,
    timeout: Timeout = DEFAULT_TIMEOUT,
    format: Annotated[
        Format, typer.Option(help="A report, the risks, the graph, or a picture in DOT.")
    ] = Format.TEXT,
    fail_on: Annotated[
        FailOn, typer.Option(help="Exit with 1 when a risk is at least this severe.")
    ] = FailOn.LOW,
    lists: Lists = None,
    output: Output = STDOUT,
) -> Outcome:
    """Find what the nodes of an app can do to each other.

    You have an app whose nodes come from several hands. The scan reads its
    interaction graph and tells which nodes can override, outrun or mislead
    which others, and how many coordination nodes would keep them apart.

    $ rtron scan graph.json
    $ rtron scan --live --format graph --fail-on never -o graph.json
    $ rtron scan graph.json --format json --fail-on high
    $ rtron scan graph.json --format dot | dot -Tsvg -o graph.svg

    Exit code: 0 no risk as severe as --fail-on, 1 risks found, 2 bad input.
    """
    app = chosen_app(graph, master if live else None, timeout)
    found = app.source.read()
    report = discover(found, load_lists(lists) if lists else None)
    exit_code = FOUND if _fails(report, fail_on) else OK
    return Outcome(_shown(app, found, report, format), exit_code, output)


def _fails(report: RiskReport, fail_on: FailOn) -> bool:
    if fail_on is FailOn.NEVER:
        return False
    order = list(Severity)
    mildest = order.index(Severity(fail_on.value))
    return any(order.index(risk.severity) >= mildest for risk in report.risks)


def _shown(app: App, graph: InteractionGraph, report: RiskReport, format: Format) -> str | Report:
    if format is Format.JSON:
        return as_json(risks_to_json(report))
    if format is Format.GRAPH:
        return as_json(graph_to_json(graph))
    if format is Format.DOT:
        return graph_to_dot(graph, report)
    next_step = f"rtron plan {app.arguments} -o rtron.yaml"
    return scan_text(Scan(graph, report, read_from=app.said, next_step=next_step))
