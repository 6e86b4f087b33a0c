"""How long the graph of a running ROS 2 app takes to read, and whether it is all of it.

60 nodes of rclpy with 300 topics, in 20 processes: on one machine alone Fast DDS finds at most 32
participants. The peer is what rclpy lists after a second, which is how long `ros2 node list`
waits without its daemon.
"""

from collections.abc import Iterator
from contextlib import ExitStack
from statistics import median
from typing import Any

from bench.common.testbed import ReportProgress, Testbed, end, python, result_of, start
from bench.common.workload import RUNS
from bench.ros2.app import NODES, TOPICS, expected_app
from figures.figure import Figure

_EACH = 3
_TRIES = 10


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the time of a read, and what it does not tell or tells wrong."""
    with ExitStack() as stack:
        progress(f"{NODES} nodes start")
        _start(testbed, stack)
        _settle(testbed)
        ours, plain = [], []
        for number in range(RUNS):
            progress(f"run {number + 1} of {RUNS}")
            ours.append(_read(testbed, "ours"))
            plain.append(_read(testbed, "plain"))
    everything = (
        len(expected_app().nodes) + len(expected_app().endpoints) + len(expected_app().services)
    )
    unit = f"of {everything} entries, {TOPICS} topics"
    faults, theirs = sum(map(_mismatches, ours)), median(map(_mismatches, plain))
    yield Figure("ros2.discovery_median", median(run["seconds"] for run in ours), None, "s")
    slowest = max(run["seconds"] for run in ours)
    yield Figure("ros2.discovery_slowest", slowest, None, "s", at_most=5.0)
    yield Figure("ros2.discovery_missing_or_wrong", faults, theirs, unit, at_most=0)


def _start(testbed: Testbed, stack: ExitStack) -> None:
    """Start the app's processes, and wait until each has said that it is ready."""
    processes = []
    for first in range(0, NODES, _EACH):
        command = python("bench.ros2.app", str(first), str(_EACH))
        processes.append(start(testbed, command, piped=True))
        stack.callback(end, processes[-1])
    for process in processes:
        if process.stdout:
            process.stdout.readline()


def _settle(testbed: Testbed) -> None:
    """Read the app until all of it is there: its nodes are busy to find each other at first."""
    for _ in range(_TRIES):
        if not _mismatches(_read(testbed, "ours")):
            return
    raise TimeoutError("the app does not start")


def _read(testbed: Testbed, reader: str) -> dict[str, Any]:
    found: dict[str, Any] = result_of(testbed, python("bench.ros2.graph_reader", reader))
    return found


def _mismatches(run: dict[str, Any]) -> int:
    return int(run["missing"] + run["wrong"])
