"""`rtron scan`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.app_options import with_app_options
from rtron.cli.support.launch_list import launch_list_text, launch_list_to_json
from rtron.cli.support.options import NameLists, Output
from rtron.cli.support.outcome import FINDINGS, OK, STDOUT, Outcome, as_json, write_files
from rtron.cli.support.progress import show_progress
from rtron.errors import InputError
from rtron.findings.triage import at_level
from rtron.reports.app.dot import graph_to_dot
from rtron.reports.app.html import graph_to_html
from rtron.reports.app.nodl import graph_to_nodl, nodl_files
from rtron.reports.app.risks_json import risks_to_json
from rtron.reports.app.rosgraph import graph_to_rosgraph
from rtron.reports.app.sarif import risks_to_sarif
from rtron.reports.app.scan_text import Scan, scan_text
from rtron.reports.text_layout import Report
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import FindingLevel, InteractionGraph, Severity, Triage
from rtron.workflows.app_selection import AppSelection, SelectedApp, select_app
from rtron.workflows.plan import propose
from rtron.workflows.scan import ScanResult, scan_graph, triage_scan, with_relative_evidence
from rtron.workflows.source_app import launches_by_name


class Format(str, Enum):
    """The output of a scan: a report, the risks, the graph in several formats, or a page."""

    TEXT = "text"
    JSON = "json"
    GRAPH = "graph"
    NODL = "nodl"
    ROSGRAPH = "rosgraph"
    DOT = "dot"
    SARIF = "sarif"
    HTML = "html"


class FailOn(str, Enum):
    """The least severity that makes a scan exit with 1."""

    LOW = "low"
    MEDIUM = "medium"
    HIGH = "high"
    NEVER = "never"


@with_app_options
def scan(  # noqa: PLR0913 - one for each option
    selection: AppSelection,
    *,
    format: Annotated[
        Format,
        typer.Option(
            help="Report, risks as JSON, graph as JSON, NoDL, rosgraph_msgs/Graph, DOT, SARIF, "
            "or an HTML page."
        ),
    ] = Format.TEXT,
    level: Annotated[
        FindingLevel,
        typer.Option(
            help="Who reads the report: regular shows what to act on, pedantic also what is only "
            "possible, auditor everything, the paper's risks too."
        ),
    ] = FindingLevel.REGULAR,
    fail_on: Annotated[
        FailOn, typer.Option(help="Exit with 1 if a finding has at least this severity.")
    ] = FailOn.LOW,
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="REPORT.json",
            help="An earlier scan's --format json: show what is new since then, and what is gone.",
        ),
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(
            metavar="rtron.toml",
            help="Findings to ignore, each with a reason.  [default: ./rtron.toml, if it is there]",
            show_default=False,
        ),
    ] = None,
    name_lists: NameLists = None,
    output: Output = STDOUT,
) -> Outcome:
    """Find what the nodes of an app can do to each other.

    The nodes of an app come from many authors. The scan reads the interaction
    graph and reports who can move the robot, and which topics and services
    nobody provides: what can happen, which nodes and lines make it so, and
    what to do.

    An app in source needs no build: give its folders and launch files.

    $ rtron scan src                             list its launch files
    $ rtron scan src --launch pkg/app.launch model:=big
    $ rtron scan src --launch pkg/app.launch --level auditor
    $ rtron scan src --launch pkg/app.launch --format html -o app.html
    $ rtron scan src --launch pkg/app.launch.py  ROS 2: .py, .xml, .yaml
    $ rtron scan src --launch pkg/app.launch.py --execute-launch
    $ rtron scan --live --format graph --fail-on never -o graph.json
    $ rtron scan --live --ros 2 --domain 7       the app in ROS 2 domain 7
    $ rtron scan graph.json --format json --fail-on high
    $ rtron scan run.bag                         the publishers in a recording
    $ rtron scan graph.json --format nodl -o nodes   ROS 2: a file for each node
    $ rtron scan src --launch pkg/app.launch --format json -o last.json
    $ rtron scan src --launch pkg/app.launch --baseline last.json    what is new

    rtron.toml ignores a finding by rule and topic, with a reason; in your own
    code a comment does: `rtron: ignore[RULE] REASON`.

    Only --execute-launch runs code of the app: the Python of its launch files.
    Never use it on files that you do not trust.

    Exit code: 0 nothing that is shown has the severity --fail-on, 1 something
    has, or nothing of the app could be read, 2 bad input. The paper's risks
    count with --level auditor.
    """
    if selection.folders and not selection.source.launches and not selection.live:
        return Outcome(_launch_list(selection.folders, format), OK, output)
    with show_progress() as progress:
        app = select_app(selection, progress)
        graph = app.source.read()
    if format in _HUMAN_FORMATS:
        graph = with_relative_evidence(graph, app.root)
    result = scan_graph(graph, name_lists)
    triage = triage_scan(result, app.root, config, baseline)
    is_failed = _is_severe(at_level(triage, level), fail_on) or _is_unread(graph, fail_on)
    exit_code = FINDINGS if is_failed else OK
    if format is Format.NODL and output.is_dir():
        write_files(output, nodl_files(graph))
        return Outcome("", exit_code)
    return Outcome(_RENDERERS[format](app, result, triage, level), exit_code, output)


def _launch_list(folders: Sequence[Path], format: Format) -> str | Report:
    """Return the launch files below folders; raise InputError if there are none."""
    if format not in {Format.TEXT, Format.JSON}:
        help = "without it, launch files are listed as text or json"
        raise InputError("--launch is missing", help=help)
    launches = launches_by_name(folders)
    if not launches:
        help = "give the folder of a ROS workspace, or of a package"
        raise InputError("no launch files", path=str(folders[0]), help=help)
    if format is Format.JSON:
        return as_json(launch_list_to_json(launches))
    return launch_list_text(launches, folders)


def _is_severe(shown: Triage, fail_on: FailOn) -> bool:
    if fail_on is FailOn.NEVER:
        return False
    order = list(Severity)
    mildest = order.index(Severity(fail_on.value))
    severities = [each.severity for each in shown.findings]
    severities += [risk.severity for risk in shown.risks]
    return any(order.index(severity) >= mildest for severity in severities)


def _is_unread(graph: InteractionGraph, fail_on: FailOn) -> bool:
    """Return whether nothing of an app was read: then no findings say nothing."""
    is_empty = not (graph.nodes or graph.endpoints or graph.topics)
    return is_empty and bool(graph.unresolved) and fail_on is not FailOn.NEVER


def _text(app: SelectedApp, result: ScanResult, triage: Triage, level: FindingLevel) -> Report:
    shown = at_level(triage, level)
    scan = Scan(
        result.graph,
        result.report,
        shown,
        read_from=app.description,
        next_step=f"rtron plan {app.arguments} -o rtron.yaml",
        hidden=tuple(each for each in triage.findings if each not in shown.findings),
        level=level,
    )
    return scan_text(scan)


def _html(result: ScanResult, triage: Triage, level: FindingLevel) -> str:
    plan = propose(result).plan
    return graph_to_html(result.graph, result.report, plan, at_level(triage, level).findings)


def _sarif(app: SelectedApp, result: ScanResult, triage: Triage, level: FindingLevel) -> str:
    """Return findings as SARIF, and the paper's risks where the text would show them too."""
    shown = at_level(triage, level)
    report = replace(result.report, risks=shown.risks)
    return risks_to_sarif(result.graph, report, app.root, shown)


_HUMAN_FORMATS = {Format.TEXT, Format.HTML, Format.DOT}
_Renderer = Callable[[SelectedApp, ScanResult, Triage, FindingLevel], str | Report]
_RENDERERS: Mapping[Format, _Renderer] = {
    Format.TEXT: _text,
    Format.JSON: lambda app, scan, triage, level: as_json(risks_to_json(scan.report, triage)),
    Format.GRAPH: lambda app, scan, triage, level: as_json(graph_to_json(scan.graph)),
    Format.NODL: lambda app, scan, triage, level: graph_to_nodl(scan.graph),
    Format.ROSGRAPH: lambda app, scan, triage, level: as_json(graph_to_rosgraph(scan.graph)),
    Format.DOT: lambda app, scan, triage, level: graph_to_dot(scan.graph, scan.report),
    Format.SARIF: _sarif,
    Format.HTML: lambda app, scan, triage, level: _html(scan, triage, level),
}
