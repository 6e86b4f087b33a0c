"""How soon the guard's audit on ROS 2 finds each intrusion.

The time begins when the intruder's publisher has a subscriber, which it looks for every ms, and
ends when the alarm stands in the guard's log, which is read every ms. The guard may know of the
intruder before its subscriber does: then the alarm comes first, and the time is below zero.
"""

import signal
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from bench.common.log_watcher import LogWatcher
from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER
from bench.common.testbed import ReportProgress, Testbed, end, python, running, start
from bench.common.workload import AUDIT_RUNS
from figures.figure import Figure
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan, flow_topic, output_topic

TOPIC = "/cmd_vel"
OUT, FLOW = output_topic(TOPIC), flow_topic(TOPIC, "flow1")
DRIVER = "/bench_driver"
OPEN = "the app hears the guard"
"""Said once the way from the planned publisher to the successor is there."""

_GRCN = "/rtron/grcn_cmd_vel"
_AT_MOST_MS = 100.0
_LIMIT_S = 30.0
INTRUSIONS = {
    "output": ("/bench_rogue", OUT),
    "flow": ("/bench_rogue", FLOW),
    "impostor": (_GRCN, OUT),
    "double": (PUBLISHER, FLOW),
}
"""The name and the topic of each intruder."""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give median and maximum for each intrusion."""
    with _scene(testbed) as scene:
        for name in INTRUSIONS:
            progress(f"{name}, {AUDIT_RUNS} times")
            late = [_time(scene, name) for _ in range(AUDIT_RUNS)]
            unit = f"ms of {len(late)}"
            yield Figure(f"ros2_audit.{name}.median", statistics.median(late), None, unit)
            worst = max(late)
            yield Figure(f"ros2_audit.{name}.max", worst, None, unit, at_most=_AT_MOST_MS)


@dataclass(frozen=True, slots=True)
class Ros2AuditScene:
    """A guard with a planned publisher and a successor, and its log."""

    testbed: Testbed
    log: LogWatcher


@contextmanager
def _scene(testbed: Testbed) -> Iterator[Ros2AuditScene]:
    node = replace(grcn(TOPIC, [PUBLISHER]), successors=(DRIVER,))
    path = testbed.folder / "ros2_audit.yaml"
    path.write_text(write_plan(Plan(app="bench", ros=2, grcn=(node,))), encoding="utf-8")
    guard = python("bench.ros2.audit_processes", "guard", str(path))
    with running(testbed, guard), running(testbed, python("bench.ros2.audit_processes", "app")):
        log = LogWatcher(testbed.folder / "errors.log")
        log.wait(OPEN, 0, _LIMIT_S)
        yield Ros2AuditScene(testbed, log)
        log.close()


def _time(scene: Ros2AuditScene, name: str) -> float:
    """Intrude once; return how late the alarm was, ms."""
    began = time.monotonic_ns()
    command = python("bench.ros2.audit_processes", "intrude", *INTRUSIONS[name])
    intruder = start(scene.testbed, command, piped=True)
    try:
        alarm_at, _ = scene.log.wait("alarm:", began, _LIMIT_S)
        first = int(intruder.stdout.readline()) if intruder.stdout else 0
    finally:
        end(intruder, signal.SIGTERM)
    scene.log.wait("no more:", alarm_at, _LIMIT_S)
    return (alarm_at - first) / 1e6
