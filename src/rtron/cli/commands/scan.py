"""`rtron scan`."""

from collections.abc import Callable, Mapping
from enum import Enum
from typing import Annotated

import typer

from rtron.cli.support.launch_list import list_launches
from rtron.cli.support.options import (
    DEFAULT_MASTER,
    Domain,
    Env,
    Execute,
    Inputs,
    Jobs,
    Launches,
    LaunchPython,
    Lists,
    Live,
    LiveTimeout,
    Master,
    NoCache,
    Output,
    Ros,
    RosOption,
    TextOrJson,
)
from rtron.cli.support.outcome import FINDINGS, OK, STDOUT, Outcome, as_json, write_files
from rtron.errors import InputError
from rtron.planning.proposal.policy_defaults import propose_plan
from rtron.reports.app.dot import graph_to_dot
from rtron.reports.app.html import graph_to_html
from rtron.reports.app.nodl import graph_to_nodl, nodl_files
from rtron.reports.app.risks_json import risks_to_json
from rtron.reports.app.rosgraph import graph_to_rosgraph
from rtron.reports.app.sarif import risks_to_sarif
from rtron.reports.app.scan_text import Scan, scan_text
from rtron.reports.text_layout import Report
from rtron.risks import discover_risks, load_lists
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import InteractionGraph, RiskReport, Severity
from rtron.workflows.app_selection import SelectedApp, select_app, select_app_options
from rtron.workflows.scan import with_relative_evidence


class Format(str, Enum):
    """What a scan gives: a report, the risks, the graph in three shapes, a picture or a page."""

    TEXT = "text"
    JSON = "json"
    GRAPH = "graph"
    NODL = "nodl"
    ROSGRAPH = "rosgraph"
    DOT = "dot"
    SARIF = "sarif"
    HTML = "html"


class FailOn(str, Enum):
    """The mildest severity that a scan does not let pass."""

    LOW = "low"
    MEDIUM = "medium"
    HIGH = "high"
    NEVER = "never"


def scan(  # noqa: PLR0913 - one for each option
    inputs: Inputs = None,
    *,
    launch: Launches = None,
    env: Env = None,
    execute_launch: Execute = False,
    launch_python: LaunchPython = None,
    live: Live = False,
    master: Master = DEFAULT_MASTER,
    ros: RosOption = Ros.AUTO,
    domain: Domain = None,
    timeout: LiveTimeout = None,
    format: Annotated[
        Format,
        typer.Option(
            help="A report, the risks, the graph, each node in NoDL, rosgraph_msgs/Graph, "
            "a picture in DOT, SARIF, or a page."
        ),
    ] = Format.TEXT,
    fail_on: Annotated[
        FailOn, typer.Option(help="Exit with 1 when a risk is at least this severe.")
    ] = FailOn.LOW,
    lists: Lists = None,
    output: Output = STDOUT,
    jobs: Jobs = None,
    no_cache: NoCache = False,
) -> Outcome:
    """Find what the nodes of an app can do to each other.

    You have an app whose nodes come from several hands. The scan reads its
    interaction graph and tells which nodes can override, outrun or mislead
    which others, and how many coordination nodes would keep them apart.

    An app in source needs no build: name its folders and launch files.

    $ rtron scan src                                     its launch files
    $ rtron scan src --launch pkg/app.launch model:=big
    $ rtron scan src --launch pkg/app.launch --format html -o app.html
    $ rtron scan src --launch pkg/app.launch.py           ROS 2: .py, .xml, .yaml
    $ rtron scan src --launch pkg/app.launch.py --execute-launch
    $ rtron scan --live --format graph --fail-on never -o graph.json
    $ rtron scan --live --ros 2 --domain 7       where ROS 2 runs, in domain 7
    $ rtron scan graph.json --format json --fail-on high
    $ rtron scan run.bag                   who published what in a recording
    $ rtron scan graph.json --format nodl -o nodes    ROS 2: a file for each node

    --execute-launch is the only option that runs anything of the app: the
    Python of its launch files. Never use it on files you do not trust.

    Exit code: 0 no risk as severe as --fail-on, 1 risks found, 2 bad input.
    """
    selection = select_app_options(
        inputs,
        launch,
        env,
        execute=execute_launch,
        python=launch_python,
        live=live,
        ros=ros,
        master=master,
        domain=domain,
        timeout=timeout,
        jobs=jobs,
        no_cache=no_cache,
    )
    if selection.folders and not launch and not live:
        return Outcome(list_launches(selection.folders, _listing_format(format)), OK, output)
    app = select_app(selection)
    graph = app.source.read()
    if format in _HUMAN_FORMATS:
        graph = with_relative_evidence(graph, app.root)
    report = discover_risks(graph, load_lists(lists) if lists else None)
    exit_code = FINDINGS if _has_severe_risk(report, fail_on) else OK
    if format is Format.NODL and output.is_dir():
        write_files(output, nodl_files(graph))
        return Outcome("", exit_code)
    return Outcome(_RENDERERS[format](app, graph, report), exit_code, output)


def _listing_format(format: Format) -> TextOrJson:
    if format not in {Format.TEXT, Format.JSON}:
        help = "without it, launch files are listed as text or json"
        raise InputError("--launch is missing", help=help)
    return TextOrJson(format.value)


def _has_severe_risk(report: RiskReport, fail_on: FailOn) -> bool:
    if fail_on is FailOn.NEVER:
        return False
    order = list(Severity)
    mildest = order.index(Severity(fail_on.value))
    return any(order.index(risk.severity) >= mildest for risk in report.risks)


def _text(app: SelectedApp, graph: InteractionGraph, report: RiskReport) -> Report:
    next_step = f"rtron plan {app.arguments} -o rtron.yaml"
    return scan_text(Scan(graph, report, read_from=app.description, next_step=next_step))


_HUMAN_FORMATS = {Format.TEXT, Format.HTML, Format.DOT}
_RENDERERS: Mapping[Format, Callable[[SelectedApp, InteractionGraph, RiskReport], str | Report]] = {
    Format.TEXT: _text,
    Format.JSON: lambda app, graph, report: as_json(risks_to_json(report)),
    Format.GRAPH: lambda app, graph, report: as_json(graph_to_json(graph)),
    Format.NODL: lambda app, graph, report: graph_to_nodl(graph),
    Format.ROSGRAPH: lambda app, graph, report: as_json(graph_to_rosgraph(graph)),
    Format.DOT: lambda app, graph, report: graph_to_dot(graph, report),
    Format.SARIF: lambda app, graph, report: risks_to_sarif(graph, report, app.root),
    Format.HTML: lambda app, graph, report: graph_to_html(
        graph, report, propose_plan(graph, report)
    ),
}
