"""Scans one app, in a process of its own: one that dies, or takes too long, costs itself only."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rtron.errors import SourceError
from rtron.sources.graph_json import parse_graph
from rtron.survey.app_listing import Subject
from rtron.survey.surveyed import Surveyed, surveyed

SECONDS = 900.0
_GRACE = 90.0
"""Seconds in which a scan that is told to stop ends what it has begun."""
_AS_GRAPH = ("--format", "graph", "--fail-on", "never", "--jobs", "1")
_FAULT = "error: "


def scan_subject(subject: Subject) -> Surveyed:
    """Return what a scan of an app tells; raise SourceError, with its words, if it fails."""
    command = [sys.executable, "-m", "rtron", "scan", str(subject.repository)]
    command += ["--launch", str(subject.launch), *_AS_GRAPH]
    environ = os.environ | {"ROS_PACKAGE_PATH": str(subject.top)}
    with _running(command, environ) as process:
        graph, said = process.communicate(timeout=SECONDS)
    if process.returncode:
        raise SourceError(_fault(said.decode(errors="replace")))
    return surveyed(subject, parse_graph(graph, subject.app))


@contextmanager
def _running(command: list[str], environ: dict[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=environ, stdout=pipe, stderr=pipe) as process:  # noqa: S603 - our own command
        try:
            yield process
        except subprocess.TimeoutExpired:
            raise SourceError(f"not done within {SECONDS:g} s") from None
        finally:
            _end(process)


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a scan so that it ends its own processes too."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=_GRACE)
        except subprocess.TimeoutExpired:
            process.kill()


def _fault(said: str) -> str:
    told = [line.removeprefix(_FAULT) for line in said.splitlines() if line.startswith(_FAULT)]
    return told[-1] if told else said.strip()[-200:] or "the scan ended without a word"
