"""Scan one app in a process of its own: a crash or a timeout costs this app only."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections import Counter
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.functions.app_categories import AppProfile, app_profile
from rtron.sources.graph_json import parse_graph
from rtron.survey.scan_process import NO_GRAPH
from rtron.workflows.scan import scan_graph

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

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
    """Return the numbers of an app's graph."""
    report = scan_graph(graph).report
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
"""Seconds for a scan to stop after SIGINT."""
_MAX_ERROR_LENGTH = 200


def scan_app(app: AppToScan) -> AppSurvey:
    """Return the numbers of an app; raise SourceError, with the reason, if its scan fails."""
    command = [sys.executable, "-m", "rtron.survey.scan_process"]
    command += [str(app.repository), str(app.launch)]
    environ = os.environ | {"ROS_PACKAGE_PATH": str(app.top)}
    with _scan_process(command, environ) as process:
        output, stderr = process.communicate(timeout=TIMEOUT_S)
    if process.returncode == NO_GRAPH:
        raise SourceError(output.decode(errors="replace"))
    if process.returncode:
        last = stderr.decode(errors="replace").strip()[-_MAX_ERROR_LENGTH:]
        raise SourceError(last or "the scan ended without a word")
    return survey_app(app, parse_graph(output, app.name))


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


def _stop(process: subprocess.Popen[bytes]) -> None:
    """End a scan so that it ends its own processes too."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=_STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            process.kill()
