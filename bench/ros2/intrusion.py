"""How much of the time an intruder commands the base although the guard stops it, on ROS 2."""

import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial

from bench.common.intrusion import (
    RATES,
    BaseLog,
    intrusion_figures,
    window_figures,
    write_intrusion_plan,
)
from bench.common.log_watcher import LogWatcher
from bench.common.testbed import ReportProgress, Testbed, open_testbed, python, running
from bench.common.workload import INTRUSIONS
from bench.ros2.audit import OUT
from figures.figure import Figure

PROCESSES = "bench.ros2.intrusion_processes"
_LIMIT_S = 120.0


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the figures of an intruder on the private output, at each rate."""
    del testbed  # each run has a domain of its own
    for rate in RATES:
        progress(f"an intruder at {rate} Hz, {INTRUSIONS} times")
        yield from intrusion_figures(f"ros2_intrusion.{rate}hz", INTRUSIONS, partial(_run, rate))


def _run(rate: int) -> dict[str, float]:
    """Let a node intrude once; return who commanded the base, and how often it was stopped."""
    with open_testbed() as testbed, ExitStack() as stack:
        plan, told = testbed.folder / "rtron.yaml", testbed.folder / "base.txt"
        told.touch()
        write_intrusion_plan(plan, 2)
        socket = str(testbed.folder / "guard.sock")
        guard = python("rtron", "guard", "--plan", str(plan), "--control-socket", socket)
        navigation, base = python(PROCESSES, "navigation"), python(PROCESSES, "base", str(told))
        for command in (guard, navigation, base):
            stack.enter_context(running(testbed, command, signal.SIGINT))
        log = LogWatcher(testbed.folder / "errors.log")
        stack.callback(log.close)
        wait_for_navigation(testbed)
        stack.enter_context(running(testbed, python(*intruding(rate))))
        alarm_at, _ = log.wait("past the guard", 0, _LIMIT_S)
        return window_figures(told, alarm_at)


def intruding(rate: int, node: str = "/bench_rogue", topic: str = OUT) -> list[str]:
    """Return the module and the words of a process that intrudes under a node's name."""
    return [PROCESSES, "intrude", str(rate), node, topic]


def wait_for_navigation(testbed: Testbed) -> None:
    """Wait until the base is driven."""
    deadline = time.monotonic() + _LIMIT_S
    while not BaseLog.read(testbed.folder / "base.txt").messages:
        if time.monotonic() > deadline:
            raise TimeoutError("the app does not start")
        time.sleep(0.01)
