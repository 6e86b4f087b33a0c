"""What a cell costs on ROS 2: latency beside the same guard without one, and the start."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager

from bench.cell.celled_route import cell_command, celled
from bench.common.latency import median, p99
from bench.common.plans import SUBSCRIBER, TWIST, grcn
from bench.common.pubsub import PUBLISHER, Load, interleave
from bench.common.testbed import ReportProgress, Testbed, run_guard, start
from bench.common.workload import HOP_SECONDS, RUNS
from bench.ros2.routes import guard
from figures.figure import Figure
from rtron.vocabulary import Plan

_RATE = 200
_RATIO = 1.3
"""What the latency through a cell may be of that without."""
_STARTS = 3
_NS_PER_MS = 1e6
_PLAN = Plan(app="bench", ros=2, grcn=(grcn("/bench_0", [PUBLISHER], TWIST),), cell=(SUBSCRIBER,))


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield latency and losses beside those without a cell, and the start."""
    without = guard()
    inside = celled(without, _PLAN, _run_celled_guard)
    load = Load(_RATE * HOP_SECONDS, _RATE)
    runs = interleave(testbed, [without, inside], load, RUNS, progress)
    for name, of in (("median", median), ("p99", p99)):
        ours, theirs = ([of([run]) for run in runs[r.name]] for r in (inside, without))
        bound = _RATIO if name == "median" else None
        yield Figure.of_runs(f"ros2.cell.latency.{name}", ours, theirs, "us", ratio_at_most=bound)
    lost = sum(run.lost for run in runs[inside.name])
    yield Figure("ros2.cell.lost", lost, None, f"messages of {RUNS * load.count}", at_most=0)
    starts = [_start_ms(testbed) for _ in range(_STARTS)]
    yield Figure.of_runs("ros2.cell.start", starts, (), "ms until the node's command runs")


def _run_celled_guard(testbed: Testbed) -> AbstractContextManager[subprocess.Popen[str]]:
    return run_guard(testbed, _PLAN)


def _start_ms(testbed: Testbed) -> float:
    """Return how long a cell takes until its node's command runs."""
    code = "import time; print(time.monotonic_ns())"
    began = time.monotonic_ns()
    process = start(
        testbed, [*cell_command(testbed, _PLAN), sys.executable, "-c", code], piped=True
    )
    return (int(process.communicate()[0]) - began) / _NS_PER_MS
