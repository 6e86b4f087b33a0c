"""What a guard takes of a core for 50 rules over 10 expressions, at 1,000 events a second.

The events tell where a robot is that drives to and fro at 2 m/s; it passes one of ten lines every
half a second, and five rules change. They come over TCPROS. The time is the kernel's count of what
the guard's process ran, user and system.
"""

import os
import time
from collections.abc import Iterator
from pathlib import Path

from bench.common.mission import EVENT, EVENT_NODE, GOAL, plan, pose, pose_type
from bench.common.testbed import ReportProgress, Testbed, run_guard
from bench.common.workload import LOAD_SECONDS
from bench.ros1.node import guard_pid
from bench.ros1.publishers import Publishers
from figures.figure import Figure
from rtron.vocabulary import MissionRule, Plan

_RULES = 50
_EXPRESSIONS = 10
_RATE = 1000
_SPEED = 2.0
_AT_MOST = 0.5
_START_S = 20.0
_STAT_TIMES = slice(11, 13)


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the guard's part of a core."""
    progress(f"{_RULES} rules at {_RATE} Hz")
    master = testbed.environ["ROS_MASTER_URI"]
    publishers = Publishers(master, pose_type(), {EVENT: EVENT_NODE})
    try:
        with run_guard(testbed, rules()):
            _wait_for(publishers)
            part, rate = _watch(guard_pid(master), publishers)
    finally:
        publishers.close()
    yield Figure("rules.load", part, None, f"of a core at {rate:.0f} Hz", at_most=_AT_MOST)


def rules() -> Plan:
    """Return the plan: the rules take the expressions in turn."""
    lines = range(1, _EXPRESSIONS + 1)
    expressions = [
        f"event.pose.position.x > {line}.0 && event.pose.position.y < 2.0" for line in lines
    ]
    return plan(
        [
            MissionRule(
                name=f"rule{number}", when=f"eflow{number % _EXPRESSIONS + 1}", block=(GOAL,)
            )
            for number in range(_RULES)
        ],
        expressions,
    )


def _wait_for(publishers: Publishers) -> None:
    deadline = time.monotonic() + _START_S
    while not publishers.connections[EVENT]:
        if time.monotonic() > deadline:
            raise TimeoutError("the guard does not listen to the events")
        time.sleep(0.05)


def _watch(pid: int, publishers: Publishers) -> tuple[float, float]:
    """Return the part of a core that the guard takes while events come, and their rate, Hz."""
    _drive(publishers, _RATE)
    ran, start = _processor_time(pid), time.monotonic()
    _drive(publishers, _RATE * LOAD_SECONDS)
    seconds = time.monotonic() - start
    return (_processor_time(pid) - ran) / seconds, _RATE * LOAD_SECONDS / seconds


def _drive(publishers: Publishers, count: int) -> None:
    start = time.monotonic()
    for number in range(count):
        left = start + number / _RATE - time.monotonic()
        if left > 0:
            time.sleep(left)
        publishers.send(EVENT, pose(_robot_position(number / _RATE), 1.0))


def _robot_position(seconds: float) -> float:
    """Return where the robot is, m: to and fro over all lines, and one more metre behind them."""
    length = _EXPRESSIONS + 1
    return length - abs(seconds * _SPEED % (2 * length) - length)


def _processor_time(pid: int) -> float:
    """Return how long a process ran so far, s (proc(5): utime and stime)."""
    after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, after_name[_STAT_TIMES])) / os.sysconf("SC_CLK_TCK")
