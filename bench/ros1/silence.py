"""From silence to the stop: how late the first stop message comes after the time in the plan.

A stream moves the robot and falls silent, again and again, on an idle machine and with a busy loop
on every core. The time runs from just before the last message is handed to the kernel to when the
first stop message was received, in one process; the hop there and back and what the measuring
process itself waits for a core are in it, nothing is subtracted. The peer is no guard but the
measuring process: how late it wakes up from a sleep as long as the silence, in the same rounds.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import replace

from bench.common.latency import quantile
from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER
from bench.common.testbed import ReportProgress, Testbed, python, result_of, run_guard, running
from bench.common.workload import SILENCES
from figures.figure import Figure
from rtron.vocabulary import SECOND, Plan, StopProfile, flow_topic, output_topic

_TOPIC = "/cmd_vel"
_SILENT_AFTER = SECOND // 10
_STOP = StopProfile(decel=1000.0, period=SECOND // 100, repeat=SECOND // 50)
_LOADS = {"idle": 20.0, "busy": 50.0}
"""What else the machine does, and how late 99 of 100 stops may be at most, ms."""
_BUSY = "import signal; signal.alarm({seconds})\nwhile True: pass"
_US_PER_MS = 1000


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give median, p99 and maximum, ms, of each load."""
    for load, at_most in _LOADS.items():
        progress(f"{SILENCES} silences, {load}")
        with run_guard(testbed, _plan()), _load(testbed, load):
            found = _measure_stops(testbed)
        yield from _compared(f"silence.{load}", found["late"], found["slept"], at_most)


def _plan() -> Plan:
    node = grcn(_TOPIC, [PUBLISHER])
    flows = (replace(node.flows[0], silent_after=_SILENT_AFTER),)
    return Plan(app="bench", grcn=(replace(node, flows=flows),), stop=_STOP)


def _measure_stops(testbed: Testbed) -> dict[str, list[int]]:
    publisher_options = ("--publish", f"{PUBLISHER}={flow_topic(_TOPIC, 'flow1')}")
    output = ("--subscribe", output_topic(_TOPIC), "--silent-after", str(_SILENT_AFTER))
    rounds = ("--rounds", str(SILENCES))
    found: dict[str, list[int]] = result_of(
        testbed, python("bench.ros1.silent_publisher", *publisher_options, *output, *rounds)
    )
    return found


def _compared(
    name: str, late: Sequence[int], slept: Sequence[int], at_most: float
) -> Iterator[Figure]:
    for part, share, bound in (("median", 0.5, None), ("p99", 0.99, at_most), ("max", 1.0, None)):
        ours, peer = (quantile(sorted(times), share) / _US_PER_MS for times in (late, slept))
        unit = f"ms of {len(late)} (peer: its own sleep)"
        yield Figure(f"{name}.{part}", ours, peer, unit, at_most=bound)


def _load(testbed: Testbed, load: str) -> AbstractContextManager[None]:
    return _busy(testbed) if load == "busy" else nullcontext()


@contextmanager
def _busy(testbed: Testbed) -> Iterator[None]:
    """Keep every core busy until the end of the block, for ten minutes at most."""
    command = [sys.executable, "-c", _BUSY.format(seconds=600)]
    with ExitStack() as stack:
        for _ in os.sched_getaffinity(0):
            stack.enter_context(running(testbed, command))
        yield
