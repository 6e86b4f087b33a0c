"""What the programs of the guard load at their start, each time, and that no terminal ends them."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

import rtron
from rtron.guard.supervision import programs

SOURCE = Path(rtron.__file__).parents[1]
ELSEWHERE = {"celpy", "fastapi", "google", "httpx", "numpy", "rich", "sqlalchemy", "tree_sitter"}
UNUSED = ELSEWHERE | {"rclpy", "rosbags", "typer", "uvicorn", "yaml"}
"""What no process of a guard needs at its start."""
SERVICE = {"asyncio", "pydantic", "websockets"}
"""What the link to a service takes."""
PLANNING = {f"rtron.{each}" for each in ("cli", "planning", "risks", "sources", "workflows")}
STREAMS = {"rtron.guard.coordinator", "rtron.guard.core.pipeline"}
PROGRAMS = [
    (programs.SUPERVISOR, STREAMS | SERVICE | {"mcap"}),
    (programs.GUARD, SERVICE | {"mcap", "rtron.guard.dry_run"}),
    (programs.BULK, SERVICE | {"mcap"}),
    (programs.LINK, STREAMS | {"mcap"}),
    (programs.INCIDENTS, STREAMS | SERVICE),
]


def modules_of(program):
    """Return the names of all modules that a program has loaded when its function begins."""
    module, _, function = program.partition(":")
    code = (
        f"import sys; from rtron.guard.supervision.{module} import {function}; print(*sys.modules)"
    )
    environment = {"PYTHONPATH": str(SOURCE)}
    ran = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    return set(ran.stdout.split())


@pytest.mark.parametrize(("program", "others"), PROGRAMS)
def test_a_process_loads_only_what_it_needs(program, others):
    assert modules_of(program) & (UNUSED | PLANNING | others) == set()


def test_a_program_that_begins_is_ended_by_no_signal_of_the_terminal(monkeypatch):
    say = "import signal; from os import _exit; _exit(len(signal.pthread_sigmask(0, ())))"
    monkeypatch.setattr(programs, "command", lambda *_: [sys.executable, "-c", say])
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    began = programs.start_program(programs.INCIDENTS, ())
    assert began.wait() == len(before | programs.TERMINAL_SIGNALS)
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == before
