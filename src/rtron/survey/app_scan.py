"""Scans one app, in a process of its own: one that dies, or takes too long, costs itself only."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.functions.app_categories import AppProfile, app_profile
from rtron.risks import discover_risks
from rtron.sources.graph_json import parse_graph
from rtron.survey.app_listing import AppToScan

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtron.survey.app_listing import AppToScan
    from rtron.vocabulary import CoordinationCount, InteractionGraph, RiskKind


@dataclass(frozen=True, slots=True, kw_only=True)
class AppSurvey:
    """An app in numbers: its graph, its risks by kind, the coordination nodes they ask for.

    `unresolved` counts what the scan could not know.
    """

    app: str
    nodes: int
    topics: int
    risks: Mapping[RiskKind, int]
    coordination_nodes: CoordinationCount
    profile: AppProfile
    unresolved: int


def survey_app(app: AppToScan, graph: InteractionGraph) -> AppSurvey:
    """Return what an app's graph tells."""
    report = discover_risks(graph)
    return AppSurvey(
        app=app.name,
        nodes=len(graph.nodes),
        topics=len(graph.topics),
        risks=Counter(risk.kind for risk in report.risks),
        coordination_nodes=report.coordination_nodes,
        profile=app_profile(graph, app.name),
        unresolved=len(graph.unresolved),
    )


TIMEOUT_S = 900.0
_STOP_TIMEOUT_S = 90.0
"""Seconds in which a scan that is told to stop ends what it has begun."""
_GRAPH_OPTIONS = ("--format", "graph", "--fail-on", "never", "--jobs", "1")
_ERROR_PREFIX = "error: "


def scan_app(app: AppToScan) -> AppSurvey:
    """Return what a scan of an app tells; raise SourceError, with its words, if it fails."""
    command = [sys.executable, "-m", "rtron", "scan", str(app.repository)]
    command += ["--launch", str(app.launch), *_GRAPH_OPTIONS]
    environ = os.environ | {"ROS_PACKAGE_PATH": str(app.top)}
    with _scan_process(command, environ) as process:
        graph, stderr = process.communicate(timeout=TIMEOUT_S)
    if process.returncode:
        raise SourceError(_error_message(stderr.decode(errors="replace")))
    return survey_app(app, parse_graph(graph, app.name))


@contextmanager
def _scan_process(command: list[str], environ: dict[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=environ, stdout=pipe, stderr=pipe) as process:  # noqa: S603 - our own command
        try:
            yield process
        except subprocess.TimeoutExpired:
            raise SourceError(f"not done within {TIMEOUT_S:g} s") from None
        finally:
            _stop(process)


def _stop(process: "subprocess.Popen[bytes]") -> None:
    """End a scan so that it ends its own processes too."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=_STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            process.kill()


def _error_message(stderr: str) -> str:
    errors = [
        line.removeprefix(_ERROR_PREFIX)
        for line in stderr.splitlines()
        if line.startswith(_ERROR_PREFIX)
    ]
    return errors[-1] if errors else stderr.strip()[-200:] or "the scan ended without a word"
