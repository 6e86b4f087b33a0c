"""How soon the guard's audit finds each intrusion.

The time begins when the intruder accepts the guarded node's connection, and ends when the alarm
stands in the guard's log, which is read every ms. rospy shows a connection before it is made: then
the alarm may come first.
"""

import random
import signal
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from typing import TypeVar

from bench.common.log_watcher import LogWatcher
from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER
from bench.common.testbed import ReportProgress, Testbed, open_testbed, python, running
from bench.common.workload import AUDIT_RUNS
from bench.ros1.audit_cost import OUT
from bench.ros1.intruder import Intruder
from figures.figure import Figure
from rtron.errors import RTronError
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan
from rtron.wire.ros1.xmlrpc import ros_call

_T = TypeVar("_T")
_DRIVER = "/bench_driver"
_GUARD = "/rtron/grcn_cmd_vel"
_AT_MOST_MS = 100.0
_LIMIT_S = 20.0
_EXPECTED_LINE = {"impostor": "alarm:"}
"""What is waited for in the log: an impostor may be dropped before it is heard."""
_PHASE_S = 0.2
"""The audit's rounds are not to fall in step with the intrusions."""
_ROGUE = "/bench_rogue"
DRIVERS = {
    "rospy": ["/usr/bin/python3", "tests/ros1/nodes/driver.py", "/dev/null", f"/cmd_vel:={OUT}"],
    "roscpp": ["/usr/lib/topic_tools/relay", OUT, "/driven"],
}
"""A node behind the guard, of each client library."""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give median and maximum for each intrusion at a node of each client library."""
    for library in DRIVERS:
        with _scene(testbed, library) as scene:
            for name in ("rogue", "ghost", "impostor", "late", "second_master"):
                progress(f"{name} at a {library} node, {AUDIT_RUNS} times")
                yield from _intrusion_figures(f"audit.{library}.{name}", _times(scene, name))


@dataclass(slots=True)
class AuditScene:
    """A guard, a node behind it that can be started anew, another master, and the guard's log."""

    testbed: Testbed
    other: str
    log: LogWatcher
    command: list[str]
    stack: ExitStack

    @property
    def master(self) -> str:
        """The address of the app's master."""
        return self.testbed.environ["ROS_MASTER_URI"]

    def start(self) -> None:
        """Start the driver anew."""
        self.stack.close()
        self.stack.enter_context(running(self.testbed, self.command, signal.SIGINT))

    def ready(self) -> str:
        """Return the driver's address once it hears the guard and nobody else is there."""
        return _wait(self._ready)

    def _ready(self) -> str:
        guard = ros_call(self.master, "lookupNode", "/bench", _GUARD, timeout=5)
        driver: str = ros_call(self.master, "lookupNode", "/bench", _DRIVER, timeout=5)
        rows = ros_call(driver, "getBusInfo", "/bench", timeout=5)
        return driver if {row[1] for row in rows if row[4] == OUT} == {guard} else ""


@contextmanager
def _scene(testbed: Testbed, library: str) -> Iterator[AuditScene]:
    node = replace(grcn("/cmd_vel", [PUBLISHER]), successors=(_DRIVER,))
    path = testbed.folder / "audit.yaml"
    path.write_text(write_plan(Plan(app="bench", grcn=(node,))), encoding="utf-8")
    log_file = testbed.folder / "errors.log"
    command = [*DRIVERS[library], f"__name:={_DRIVER[1:]}"]
    with (
        open_testbed() as other,
        running(testbed, python("bench.ros1.guard_process", str(path), "--audit")),
    ):
        log, stack = LogWatcher(log_file), ExitStack()
        scene = AuditScene(testbed, other.environ["ROS_MASTER_URI"], log, command, stack)
        scene.start()
        yield scene
        stack.close()
        log.close()


def _times(scene: AuditScene, name: str) -> list[float]:
    """Intrude again and again; return how late each alarm was, ms."""
    late, chance = [], random.Random(1)
    for _ in range(AUDIT_RUNS):
        uri = scene.ready()
        time.sleep(chance.uniform(0.0, _PHASE_S))
        if name == "late":
            scene.stack.close()
        began = time.monotonic_ns()
        named = _GUARD if name == "impostor" else _ROGUE
        with Intruder(named, OUT) as intruder:
            _intrude(scene, name, intruder, uri)
            _wait(lambda each=intruder: each.first)
            alarm_at, _ = scene.log.wait(_EXPECTED_LINE.get(name, "hears"), began, _LIMIT_S)
            late.append((alarm_at - intruder.first_connection) / 1e6)
            if name in ("rogue", "late"):
                intruder.unregister(scene.master)
            if name == "second_master":
                intruder.unregister(scene.other)
        scene.log.wait("no more:", alarm_at, _LIMIT_S)
    return late


def _intrude(scene: AuditScene, name: str, intruder: Intruder, uri: str) -> None:
    if name == "ghost":
        guard = ros_call(scene.master, "lookupNode", "/bench", _GUARD, timeout=5)
        intruder.announce_to(uri, guard)
    elif name == "second_master":
        intruder.announce_through(scene.other, _DRIVER, uri)
    else:
        intruder.register(scene.master)
    if name == "late":
        scene.start()


def _intrusion_figures(name: str, late: list[float]) -> Iterator[Figure]:
    unit = f"ms of {len(late)}"
    yield Figure(f"{name}.median", statistics.median(late), None, unit)
    yield Figure(f"{name}.max", max(late), None, unit, at_most=_AT_MOST_MS)


def _wait(condition: Callable[[], _T]) -> _T:
    """Return what a condition gives once it is true; what cannot be reached yet is not."""
    deadline = time.monotonic() + _LIMIT_S
    while time.monotonic() < deadline:
        try:
            if found := condition():
                return found
        except RTronError:
            pass  # not ready yet: try again
        time.sleep(0.01)
    raise TimeoutError("what was waited for did not come")
