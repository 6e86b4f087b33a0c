"""How much of the time an intruder commands the base although the guard stops it, on ROS 1."""

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from tempfile import mkdtemp

from bench.common.intrusion import (
    DRIVER,
    RATES,
    TOPIC,
    BaseLog,
    intrusion_figures,
    window_figures,
    write_intrusion_plan,
)
from bench.common.log_watcher import LogWatcher
from bench.common.testbed import ReportProgress, Testbed, open_testbed, python, running
from bench.common.workload import INTRUSIONS
from bench.ros1.audit_cost import OUT
from bench.ros1.intruder import Intruder, RepeatingGhost
from figures.figure import Figure
from rtron.errors import RTronError
from rtron.wire.ros1.xmlrpc import ros_call

_GUARD, _SUPERVISOR = "/rtron/grcn_cmd_vel", "/rtron_supervisor"
_LIMIT_S = 120.0
_SYSTEM_PYTHON = "/usr/bin/python3"
LIBRARIES = ("rospy", "roscpp")
GHOSTS = ("once", "repeated")
"""How often the ghost tells the driver of itself; `repeated` is every 20 ms, and of nobody else."""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the figures of each ghost at a driver of each client library."""
    del testbed  # each run has a master of its own
    for library in LIBRARIES:
        for ghost in GHOSTS:
            for rate in RATES:
                progress(f"a ghost at {rate} Hz, {ghost}, at {library}, {INTRUSIONS} times")
                name = f"intrusion.{library}.{ghost}.{rate}hz"
                yield from intrusion_figures(name, INTRUSIONS, partial(_run, library, ghost, rate))


def _run(library: str, ghost: str, rate: int) -> dict[str, float]:
    """Let a ghost intrude once; return who commanded the base, and how often it was stopped."""
    with open_testbed() as testbed, ExitStack() as stack:
        log = _start_app(testbed, library, stack)
        driver = _wait(partial(_hears, testbed, {_GUARD, _SUPERVISOR}))
        _wait(lambda: BaseLog.read(testbed.folder / "base.txt").messages)
        intruder = _create_ghost(ghost, rate, driver)
        with intruder:
            if ghost == "once":
                intruder.announce_to(driver, _uri(testbed, _GUARD), _uri(testbed, _SUPERVISOR))
            alarm_at, _ = log.wait(" hears ", 0, _LIMIT_S)
            before = intruder.connection_count
            found = window_figures(testbed.folder / "base.txt", alarm_at)
            return found | {"reconnects": intruder.connection_count - before}


def _start_app(testbed: Testbed, library: str, stack: ExitStack) -> LogWatcher:
    plan, told = testbed.folder / "rtron.yaml", testbed.folder / "base.txt"
    told.touch()
    write_intrusion_plan(plan, 1)
    socket = Path(mkdtemp(dir=testbed.folder)) / "guard.sock"
    guard = python("rtron", "guard", "--plan", str(plan), "--control-socket", str(socket))
    name = f"__name:={DRIVER[1:]}"
    base = [_SYSTEM_PYTHON, "tests/ros1/nodes/timed_driver.py", str(told)]
    nodes = [[*base, name, f"{TOPIC}:={OUT}"]]
    if library == "roscpp":
        nodes = [
            ["/usr/lib/topic_tools/relay", OUT, "/driven", name],
            [*base, f"{TOPIC}:=/driven", "__name:=base"],
        ]
    navigation = ["tests/ros1/nodes/nav.py", "__name:=bench_pub", f"{TOPIC}:=/rtron{TOPIC}/flow1"]
    for command in (guard, *nodes, [_SYSTEM_PYTHON, *navigation]):
        stack.enter_context(running(testbed, command, signal.SIGINT))
    log = LogWatcher(testbed.folder / "errors.log")
    stack.callback(log.close)
    return log


def _create_ghost(ghost: str, rate: int, driver: str) -> Intruder:
    if ghost == "once":
        return Intruder("/ghost", OUT, rate)
    return RepeatingGhost("/ghost", OUT, rate, driver)


def _hears(testbed: Testbed, nodes: set[str]) -> str:
    """Return the driver's address once it hears these nodes, nothing before."""
    driver = _uri(testbed, DRIVER)
    rows = ros_call(driver, "getBusInfo", "/bench", timeout=5)
    heard = {row[1] for row in rows if row[4] == OUT}
    return driver if {_uri(testbed, node) for node in nodes} <= heard else ""


def _uri(testbed: Testbed, node: str) -> str:
    master = testbed.environ["ROS_MASTER_URI"]
    uri: str = ros_call(master, "lookupNode", "/bench", node, timeout=5)
    return uri


def _wait(condition: Callable[[], object]) -> str:
    deadline = time.monotonic() + _LIMIT_S
    while time.monotonic() < deadline:
        try:
            if found := condition():
                return str(found)
        except RTronError:
            pass  # not ready yet: try again
        time.sleep(0.01)
    raise TimeoutError("the app does not start")
