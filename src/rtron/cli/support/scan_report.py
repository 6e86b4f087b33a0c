"""What `rtron scan` writes: a scan in one of its formats, and the exit code that it ends with."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from rtron.cli.support.outcome import FINDINGS, OK, STDOUT, Outcome, as_json, write_files
from rtron.cli.support.progress import show_progress
from rtron.errors import InputError
from rtron.findings.folding import fold
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
from rtron.workflows.scan import (
    ScanResult,
    read_source_lines,
    scan_graph,
    triage_scan,
    with_relative_evidence,
)
from rtron.workflows.source_app import launches_by_name

if TYPE_CHECKING:
    from rich.text import Text

    from rtron.sources.launch.common.launch_file import LaunchFileInfo


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanReport:
    """How a scan is reported: its format, its reader, and what makes it exit with 1."""

    format: str
    level: FindingLevel
    fail_on: Severity | None
    name_lists: Path | None
    config: Path | None
    baseline: Path | None
    output: Path = STDOUT


def run_scan(selection: AppSelection, options: ScanReport) -> Outcome:
    """Return the report of an app, or its launch files if none of them is chosen."""
    if selection.folders and not selection.source.launches and not selection.live:
        return Outcome(_launch_list(selection.folders, options.format), OK, options.output)
    with show_progress() as progress:
        app = select_app(selection, progress)
        graph = app.source.read()
    if options.format in _HUMAN_FORMATS:
        graph = with_relative_evidence(graph, app.root)
    result = scan_graph(graph, options.name_lists)
    triage = triage_scan(result, app.root, options.config, options.baseline)
    shown = at_level(triage, options.level)
    is_failed = options.fail_on and (_is_severe(shown, options.fail_on) or _is_unread(graph))
    exit_code = FINDINGS if is_failed else OK
    if options.format == "nodl" and options.output.is_dir():
        write_files(options.output, nodl_files(graph))
        return Outcome("", exit_code)
    text = _RENDERERS[options.format](app, result, triage, options.level)
    return Outcome(text, exit_code, options.output)


def _launch_list(folders: Sequence[Path], format: str) -> str | Report:
    """Return the launch files below folders; raise InputError if there are none."""
    if format not in {"text", "json"}:
        help = "without it, launch files are listed as text or json"
        raise InputError("--launch is missing", help=help)
    launches = launches_by_name(folders)
    if not launches:
        help = "give the folder of a ROS workspace, or of a package"
        raise InputError("no launch files", path=str(folders[0]), help=help)
    if format == "json":
        return as_json(launch_list_to_json(launches))
    return launch_list_text(launches, folders)


def _is_severe(shown: Triage, mildest: Severity) -> bool:
    order = list(Severity)
    severities = [each.severity for each in shown.findings]
    severities += [risk.severity for risk in shown.risks]
    return any(order.index(severity) >= order.index(mildest) for severity in severities)


def _is_unread(graph: InteractionGraph) -> bool:
    """Return whether nothing of an app was read: then no findings say nothing."""
    is_empty = not (graph.endpoints or graph.topics) and all(node.unread for node in graph.nodes)
    return bool(graph.unresolved) and is_empty


def _text(app: SelectedApp, result: ScanResult, triage: Triage, level: FindingLevel) -> Report:
    triage = replace(triage, findings=fold(triage.findings))
    shown = at_level(triage, level)
    scan = Scan(
        result.graph,
        result.report,
        shown,
        read_from=app.description,
        next_step=f"rtron plan {app.arguments} -o rtron.yaml",
        hidden=tuple(each for each in triage.findings if each not in shown.findings),
        level=level,
        guess=app.guess,
        inventory=result.inventory,
    )
    return scan_text(scan)


def _html(app: SelectedApp, result: ScanResult, triage: Triage, level: FindingLevel) -> str:
    plan, findings = propose(result).plan, fold(at_level(triage, level).findings)
    lines = read_source_lines(findings, app.root)
    return graph_to_html(result.graph, result.report, plan, findings, lines, result.inventory)


def _sarif(app: SelectedApp, result: ScanResult, triage: Triage, level: FindingLevel) -> str:
    """Return findings as SARIF, and the paper's risks where the text would show them too."""
    shown = at_level(triage, level)
    report = replace(result.report, risks=shown.risks)
    return risks_to_sarif(result.graph, report, app.root, shown, result.inventory)


_HUMAN_FORMATS = {"text", "html", "dot"}
_Renderer = Callable[[SelectedApp, ScanResult, Triage, FindingLevel], str | Report]
_RENDERERS: Mapping[str, _Renderer] = {
    "text": _text,
    "json": lambda app, scan, triage, level: as_json(
        risks_to_json(scan.report, triage, scan.inventory)
    ),
    "graph": lambda app, scan, triage, level: as_json(graph_to_json(scan.graph)),
    "nodl": lambda app, scan, triage, level: graph_to_nodl(scan.graph),
    "rosgraph": lambda app, scan, triage, level: as_json(graph_to_rosgraph(scan.graph)),
    "dot": lambda app, scan, triage, level: graph_to_dot(scan.graph, scan.report),
    "sarif": _sarif,
    "html": _html,
}


LAUNCHES_SCHEMA = "rtron.launches/1"


def launch_list_text(launches: "Mapping[str, LaunchFileInfo]", folders: Sequence[Path]) -> "Report":
    """Return the launch files with their arguments, and the command that scans one."""
    from rtron.reports.text_layout import Report

    return Report(lambda _: _lines(launches, folders))


def launch_list_to_json(found: "Mapping[str, LaunchFileInfo]") -> dict[str, object]:
    """Return the launch files as a JSON document."""
    launches = [
        {
            "launch": name,
            "path": str(each.path),
            "package": each.package,
            "required": list(each.required),
            "optional": list(each.optional),
            "error": each.error,
        }
        for name, each in found.items()
    ]
    return {"schema": LAUNCHES_SCHEMA, "launches": launches}


def _lines(found: "Mapping[str, LaunchFileInfo]", folders: Sequence[Path]) -> "list[Text]":
    from rtron.reports.text_layout import columns, counted, line

    rows = [(name, _argument_text(each)) for name, each in found.items()]
    arguments = [
        *map(str, folders),
        "--launch",
        min(found, key=lambda name: _unlikeliness(name, found[name])),
    ]
    return [
        line((counted(len(found), "launch file"), "bold")),
        *columns(rows, ("cyan", "dim"), indent=2),
        line(),
        line("next  ", ("rtron scan " + " ".join(map(quote, arguments)), "bold")),
    ]


def _argument_text(launch: "LaunchFileInfo") -> str:
    if launch.error:
        return "cannot be read"
    required = [f"{name}:=…" for name in launch.required]
    return " ".join((*required, *(f"[{name}:=…]" for name in launch.optional)))


_LIKELY = ("bringup", "navigation", "nav2", "navigate", "robot", "core", "main", "demo", "start")
"""Words in the names of launch files that start a whole app, the likeliest first."""
_PARTS = ("test", "rviz", "teleop", "description", "upload", "calibrat", "spawn", "example")
"""Words in the names of those that start a part of one, or a tool."""


def _unlikeliness(name: str, launch: "LaunchFileInfo") -> tuple[bool, bool, int, int, str]:
    """Return how far a launch file is from being the one that starts the app, the least first.

    Its own name counts before its package's, and of two the one that includes more.
    """
    file = launch.path.name.lower()
    words = [i for i, word in enumerate(_LIKELY) if word in file]
    in_package = [i for i, word in enumerate(_LIKELY) if word in launch.package.lower()]
    likely = min(words, default=len(_LIKELY) + min(in_package, default=len(_LIKELY)))
    is_part = any(word in file for word in _PARTS)
    return bool(launch.error), is_part, likely, len(launch.required) - len(launch.includes), name
