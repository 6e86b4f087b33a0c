"""What a cell costs, and how soon the robot stops when guard and supervisor are gone together."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TypeAlias

from bench.cell.celled_route import cell_command, celled
from bench.common.latency import median, p99, quantile
from bench.common.plans import SUBSCRIBER, grcn
from bench.common.process_usage import processor_ns
from bench.common.pubsub import PUBLISHER, Load, Route, interleave
from bench.common.testbed import ReportProgress, Testbed, end, python, run_guard, start
from bench.common.workload import CELL_ROUNDS, HOP_SECONDS, RUNS
from bench.ros1.routes import guard
from figures.figure import Figure
from rtron.vocabulary import Plan

_RATE = 200
_RATIO = 1.3
"""What the latency through a cell may be of that without."""
_STOP_MS = 100.0
_FROZEN_MS = 400.0
_NS_PER_US, _NS_PER_MS = 1000, 1e6
_LOAD_S = 5.0
Process: TypeAlias = subprocess.Popen[str]
_PLAN = Plan(app="bench", grcn=(grcn("/cmd_vel", [PUBLISHER]),), cell=(SUBSCRIBER,))


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield latency and processor time beside those without a cell, start, and first stops."""
    without, celled = guard(), _celled_route()
    load = Load(_RATE * HOP_SECONDS, _RATE)
    runs = interleave(testbed, [without, celled], load, RUNS, progress)
    for name, of in (("median", median), ("p99", p99)):
        inside, outside = ([of([run]) for run in runs[r.name]] for r in (celled, without))
        bound = _RATIO if name == "median" else None
        yield Figure.of_runs(f"cell.latency.{name}", inside, outside, "us", ratio_at_most=bound)
    lost = sum(run.lost for run in runs[celled.name])
    yield Figure("cell.lost", lost, None, f"messages of {RUNS * load.count}", at_most=0)
    progress("processor time")
    shares = [[_processor_share(testbed, route) for _ in range(3)] for route in (celled, without)]
    yield Figure.of_runs("cell.processor", *shares, "% of a core, 50 commands/s")
    starts = [_start_ms(testbed) for _ in range(3)]
    yield Figure.of_runs("cell.start", starts, (), "ms until the node's command runs")
    kill, freeze = ("kill", signal.SIGKILL, _STOP_MS), ("freeze", signal.SIGSTOP, _FROZEN_MS)
    for name, number, bound in (kill, freeze):
        progress(f"{CELL_ROUNDS} times: {name} guard and supervisor")
        times = sorted(_first_stop(testbed, number) for _ in range(CELL_ROUNDS))
        middle, latest = quantile(times, 0.5), quantile(times, 1.0)
        unit = f"ms of {len(times)}"
        yield Figure(f"cell.{name}.stop.median", middle / _NS_PER_US, None, unit)
        yield Figure(f"cell.{name}.stop.max", latest / _NS_PER_US, None, unit, at_most=bound)


def _celled_route() -> Route:
    return celled(guard(), _PLAN, lambda testbed: run_guard(testbed, _PLAN))


def _processor_share(testbed: Testbed, route: Route) -> float:
    """Return what guard and cell take of a core at 50 commands a second, %."""
    with _driven(testbed, route) as processes:
        trees = [process.pid for process in processes]
        before, began = sum(map(_tree_ns, trees)), time.monotonic_ns()
        time.sleep(_LOAD_S)
        used = sum(map(_tree_ns, trees)) - before
        return 100 * used / (time.monotonic_ns() - began)


@contextmanager
def _driven(testbed: Testbed, route: Route) -> Iterator[tuple[Process, Process]]:
    """Drive over a route for as long as the block lasts; yield the guard and the driver."""
    publish = ("--publish", *route.inputs, "--count", "1", "--limit", "120")
    command = [*route.listen_prefix(testbed), *python("bench.cell.driver")]
    with route.start(testbed) as guard_process, ExitStack() as stack:
        driver = start(testbed, command, piped=True)
        stack.callback(end, driver)
        sender = start(testbed, python("bench.ros1.generator", *publish), piped=True)
        stack.callback(end, sender)
        _await_word(driver, "moves")
        yield guard_process, driver


def _await_word(driver: Process, word: str) -> int:
    """Return when a driver has said a word, ns."""
    for line in driver.stdout or ():
        if line.startswith(word):
            return int(line.split()[1])
    raise TimeoutError(f"the driver never {word}")


def _start_ms(testbed: Testbed) -> float:
    """Return how long a cell takes until its node's command runs."""
    code = "import time; print(time.monotonic_ns())"
    began = time.monotonic_ns()
    command = [*cell_command(testbed, _PLAN), sys.executable, "-c", code]
    process = start(testbed, command, piped=True)
    printed = process.communicate()[0]
    return (int(printed) - began) / _NS_PER_MS


def _first_stop(testbed: Testbed, number: int) -> int:
    """Return how long after the end of guard and supervisor the node hears a stop, ns."""
    with _driven(testbed, _celled_route()) as (guard_process, driver):
        time.sleep(1)
        tree = _tree(guard_process.pid)
        began = time.monotonic_ns()
        _send_all(tree, number)
        stopped = _await_word(driver, "rests")
        _send_all(tree, signal.SIGKILL)
    return stopped - began


def _send_all(pids: Sequence[int], number: int) -> None:
    for pid in pids:
        with suppress(ProcessLookupError):
            os.kill(pid, number)


def _tree(pid: int) -> list[int]:
    """Return a process and all below it, the first one first."""
    found = [pid]
    for each in found:
        with suppress(OSError):
            text = Path(f"/proc/{each}/task/{each}/children").read_text()
            found += map(int, text.split())
    return found


def _tree_ns(pid: int) -> int:
    return sum(map(processor_ns, _tree(pid)))
