"""Where it is measured: a ROS master of our own, and processes that end with their block."""

import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from figures.figure import Figure
from rtron.demos.runtime.isolation import free_port
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan

_START_S = 20.0
_STOP_S = 5.0
_DOMAINS = 100
ROOT = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class Testbed:
    """A running master, the environment that leads to it, and a folder for files."""

    environ: Mapping[str, str]
    folder: Path


@contextmanager
def open_testbed() -> Iterator[Testbed]:
    """Run a master on a free port until the end of the block."""
    with tempfile.TemporaryDirectory(prefix="rtron-bench-") as name:
        port = free_port()
        testbed = Testbed(_environ(Path(name), port), Path(name))
        with running(testbed, ["rosmaster", "--core", "-p", str(port)], signal.SIGINT):
            wait_for_port(port)
            yield testbed


@contextmanager
def running(
    testbed: Testbed, command: Sequence[str], stop: signal.Signals = signal.SIGTERM
) -> Iterator[subprocess.Popen[str]]:
    """Run a command until the end of the block; its output goes to a file in the folder."""
    process = start(testbed, command, piped=False)
    try:
        yield process
    finally:
        end(process, stop)


def start(testbed: Testbed, command: Sequence[str], *, piped: bool) -> subprocess.Popen[str]:
    """Start a command, with standard input and output piped or none; errors go to a file."""
    pipe = subprocess.PIPE if piped else subprocess.DEVNULL
    with (testbed.folder / "errors.log").open("a") as errors:
        return subprocess.Popen(
            command,
            env=testbed.environ,
            cwd=ROOT,
            stdin=pipe,
            stdout=pipe,
            stderr=errors,
            text=True,
        )


def end(process: subprocess.Popen[str], stop: signal.Signals = signal.SIGTERM) -> None:
    """Ask a process to stop, kill it if it does not, and close its pipes."""
    process.send_signal(stop)
    try:
        process.wait(_STOP_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    for pipe in (process.stdin, process.stdout):
        if pipe:
            pipe.close()


def result_of(testbed: Testbed, command: Sequence[str]) -> Any:  # noqa: ANN401 - any JSON value
    """Run a command to its end and return what it prints, a line of JSON."""
    process = start(testbed, command, piped=True)
    try:
        printed = process.communicate()[0]
    finally:
        end(process)
    if not printed:
        raise subprocess.SubprocessError(last_errors(testbed))
    return json.loads(printed)


def python(module: str, *args: str) -> list[str]:
    """Return the command that runs a module as this Python does."""
    return [sys.executable, "-m", module, *args]


def last_errors(testbed: Testbed) -> str:
    """Return the last lines that any process wrote to standard error."""
    lines = (testbed.folder / "errors.log").read_text(errors="replace").splitlines()
    return "\n".join(lines[-10:])


def _environ(folder: Path, port: int) -> dict[str, str]:
    return os.environ | {
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_HOSTNAME": "localhost",
        "ROS_HOME": str(folder),
        "ROS_LOG_DIR": str(folder),
        "XDG_STATE_HOME": str(folder),
        "ROS_DOMAIN_ID": str(os.getpid() % _DOMAINS + 1),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }


@contextmanager
def run_guard(testbed: Testbed, plan: Plan) -> Iterator[subprocess.Popen[str]]:
    """Run a guard with this plan until the end of the block."""
    path = testbed.folder / "rtron.yaml"
    path.write_text(write_plan(plan), encoding="utf-8")
    command = python("rtron", "guard", "--plan", str(path), "--log-level", "warning")
    with running(testbed, command) as process:
        yield process


def wait_for_port(port: int) -> None:
    """Wait until somebody listens on a port of loopback; TimeoutError if nobody does."""
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        if _listens(port):
            return
        time.sleep(0.05)
    raise TimeoutError(f"nobody listens on port {port}")


def _listens(port: int) -> bool:
    with socket.socket() as sock:
        return sock.connect_ex(("127.0.0.1", port)) == 0


ReportProgress = Callable[[str], None]
"""Tells what is being done."""
Part = Callable[[Testbed, ReportProgress], Iterator[Figure]]
"""Measures, and gives each figure as soon as it is known."""
