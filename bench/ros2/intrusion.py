"""How much of the time an intruder commands the base although the guard stops it, on ROS 2."""

import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial

from bench.common.intrusion import (
    INTRUDER,
    NAVIGATION,
    RATES,
    WINDOW,
    BaseLog,
    intrusion_figures,
    write_intrusion_plan,
)
from bench.common.log_watcher import LogWatcher
from bench.common.testbed import ReportProgress, Testbed, open_testbed, python, running
from bench.common.workload import INTRUSIONS
from figures.figure import Figure

_PROCESSES = "bench.ros2.intrusion_processes"
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
        for command in (guard, python(_PROCESSES, "app", str(told))):
            stack.enter_context(running(testbed, command, signal.SIGINT))
        log = LogWatcher(testbed.folder / "errors.log")
        stack.callback(log.close)
        _wait_for_navigation(testbed)
        stack.enter_context(running(testbed, python(_PROCESSES, "intrude", str(rate))))
        alarm_at, _ = log.wait("past the guard", 0, _LIMIT_S)
        time.sleep(WINDOW / 1e9)
        base = BaseLog.read(told)
        end = alarm_at + WINDOW
        return {
            "share": base.share(INTRUDER, alarm_at, end),
            "navigation_share": base.share(NAVIGATION, alarm_at, end),
            "stops": base.stops(alarm_at, end),
        }


def _wait_for_navigation(testbed: Testbed) -> None:
    deadline = time.monotonic() + _LIMIT_S
    while not BaseLog.read(testbed.folder / "base.txt").messages:
        if time.monotonic() > deadline:
            raise TimeoutError("the app does not start")
        time.sleep(0.01)
