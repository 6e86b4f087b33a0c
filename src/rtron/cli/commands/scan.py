"""`rtron scan`."""

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import NameLists, Output, with_app_options
from rtron.cli.support.outcome import STDOUT, Outcome

if TYPE_CHECKING:
    from rtron.workflows.app_selection import AppSelection


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


class Level(str, Enum):
    """Who reads the report; the levels of a finding."""

    REGULAR = "regular"
    PEDANTIC = "pedantic"
    AUDITOR = "auditor"


class FailOn(str, Enum):
    """The least severity that makes a scan exit with 1."""

    LOW = "low"
    MEDIUM = "medium"
    HIGH = "high"
    NEVER = "never"


@with_app_options
def scan(  # noqa: PLR0913 - one for each option
    selection: "AppSelection",
    *,
    format: Annotated[
        Format,
        typer.Option(
            help="Report, risks as JSON, graph as JSON, NoDL, rosgraph_msgs/Graph, DOT, SARIF, "
            "or an HTML page."
        ),
    ] = Format.TEXT,
    level: Annotated[
        Level,
        typer.Option(
            help="Who reads the report: regular shows what to act on, pedantic also what is only "
            "possible, auditor everything, the paper's risks too."
        ),
    ] = Level.REGULAR,
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
    $ rtron scan src/pkg/launch/app.launch       with the source of its package
    $ rtron scan src --launch pkg/app.launch --level auditor
    $ rtron scan src --launch pkg/app.launch --format html -o app.html
    $ rtron scan src --launch pkg/app.launch.py  ROS 2: .py, .xml, .yaml
    $ rtron scan --live --format graph --fail-on never -o graph.json
    $ rtron scan --live --ros 2 --domain 7       the app in ROS 2 domain 7
    $ rtron scan graph.json --format json --fail-on high
    $ rtron scan run.bag                         the publishers in a recording
    $ rtron scan graph.json --format nodl -o nodes   ROS 2: a file for each node
    $ rtron scan src --launch pkg/app.launch --format json -o last.json
    $ rtron scan src --launch pkg/app.launch --baseline last.json    what is new

    rtron.toml ignores a finding by rule and topic, with a reason; in your own
    code a comment does: `rtron: ignore[RULE] REASON`.

    Exit code: 0 nothing that is shown has the severity --fail-on, 1 something
    has, or nothing of the app could be read, 2 bad input. The paper's risks
    count with --level auditor.
    """
    from rtron.cli.support.scan_report import ScanReport, run_scan
    from rtron.vocabulary import FindingLevel, Severity

    report = ScanReport(
        format=format.value,
        level=FindingLevel(level.value),
        fail_on=None if fail_on is FailOn.NEVER else Severity(fail_on.value),
        name_lists=name_lists,
        config=config,
        baseline=baseline,
        output=output,
    )
    return run_scan(selection, report)
