"""One run of generator and receiver over a way, and many runs over several ways, interleaved."""

import json
import subprocess
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from bench.common.testbed import ReportProgress, Testbed, end, last_errors, python, start
from bench.ros1.routes import Route


@dataclass(frozen=True, slots=True)
class Load:
    """What is sent: `count` messages at `rate` a second in all, `burst` at a time.

    `expected` is how many should arrive; None: all.
    """

    count: int
    rate: int
    message: str = "twist"
    burst: int = 1
    expected: int | None = None

    @property
    def arriving(self) -> int:
        """Return how many should arrive."""
        return self.count if self.expected is None else self.expected

    @property
    def limit(self) -> int:
        """Return after how long a run is given up, s."""
        return 60 + 2 * self.count // self.rate


@dataclass(frozen=True, slots=True)
class LoadResult:
    """What came of a run; `late_ms` is how far the generator fell behind its schedule."""

    latencies_ns: tuple[int, ...]
    sequences: tuple[int, ...]
    disordered: int
    lost: int
    late_ms: float
    seconds: float


def run_load(testbed: Testbed, route: Route, load: Load) -> LoadResult:
    """Open a way, send a load over it, and close it again."""
    with route.start(testbed), ExitStack() as stack:
        receiver = _started(testbed, stack, _receiver(route, load))
        generator = _started(testbed, stack, _generator(route, load))
        _expect_ready(testbed, route, receiver)
        sent = _result(testbed, route, _exchange_line(generator, "go"))
        came = _result(testbed, route, _exchange_line(receiver, "the end"))
        _finish(generator)
    return LoadResult(
        latencies_ns=tuple(came["latencies_ns"]),
        sequences=tuple(came["sequences"]),
        disordered=came["disordered"],
        lost=load.arriving - len(set(came["sequences"])),
        late_ms=sent["late_ms"],
        seconds=sent["seconds"],
    )


def interleave(
    testbed: Testbed, routes: Sequence[Route], load: Load, runs: int, progress: ReportProgress
) -> dict[str, list[LoadResult]]:
    """Run every way `runs` times, in turn, so that what disturbs one disturbs all."""
    found: dict[str, list[LoadResult]] = {route.name: [] for route in routes}
    for number in range(1, runs + 1):
        for route in routes:
            progress(f"{route.name}, run {number} of {runs}")
            found[route.name].append(run_load(testbed, route, load))
    return found


def _receiver(route: Route, load: Load) -> list[str]:
    options = ("--count", str(load.arriving), "--message", load.message)
    limit = ("--limit", str(load.limit))
    return python(
        route.endpoint_module("receiver"), "--subscribe", *route.outputs, *options, *limit
    )


def _generator(route: Route, load: Load) -> list[str]:
    options = ("--count", str(load.count), "--message", load.message, "--limit", str(load.limit))
    pace = ("--rate", str(load.rate), "--burst", str(load.burst))
    return python(route.endpoint_module("generator"), "--publish", *route.inputs, *options, *pace)


def _started(testbed: Testbed, stack: ExitStack, command: list[str]) -> subprocess.Popen[str]:
    process = start(testbed, command, piped=True)
    stack.callback(end, process)
    return process


def _expect_ready(testbed: Testbed, route: Route, receiver: subprocess.Popen[str]) -> None:
    if not receiver.stdout or receiver.stdout.readline() != "ready\n":
        raise TimeoutError(f"{route.name}: not every topic is heard\n{last_errors(testbed)}")


def _exchange_line(process: subprocess.Popen[str], line: str) -> str:
    """Say a line to a process and return its next one; empty if it ended."""
    if not process.stdin or not process.stdout:
        raise ValueError("the process is not piped")
    try:
        process.stdin.write(line + "\n")
        process.stdin.flush()
    except BrokenPipeError:
        pass  # a receiver that has all it waits for does not listen any more
    return process.stdout.readline()


def _result(testbed: Testbed, route: Route, line: str) -> dict[str, Any]:
    if not line:
        raise TimeoutError(f"{route.name}: a process gave up\n{last_errors(testbed)}")
    result: dict[str, Any] = json.loads(line)
    return result


def _finish(process: subprocess.Popen[str]) -> None:
    """Let a process take back its registrations."""
    _exchange_line(process, "the end")
    process.wait()
