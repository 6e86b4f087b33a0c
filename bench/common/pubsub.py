"""Runs of a generator and a receiver over a route, and many runs over several routes in turn."""

import json
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, field
from typing import Any

from bench.common.testbed import ReportProgress, Testbed, end, last_errors, python, start
from bench.common.workload import SETTLE_SECONDS

PUBLISHER = "/bench_pub"
StartRoute = Callable[[Testbed], AbstractContextManager[Any]]
_SECOND = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Route:
    """A path from publishers to subscribers: publish at `inputs` (NODE=TOPIC), listen at `outputs`.

    `start` starts what is in between; `ros` is the generation of the endpoints. `listen_prefix` is
    what runs the command that listens.
    """

    name: str
    inputs: Sequence[str]
    outputs: Sequence[str]
    start: StartRoute = field(default=lambda _: nullcontext())
    ros: int = 1
    listen_prefix: Callable[[Testbed], Sequence[str]] = field(default=lambda _: ())

    def endpoint_module(self, name: str) -> str:
        """Return the module of a publishing or subscribing process."""
        return f"bench.ros{self.ros}.{name}"


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
    """Open a way, let it settle, send a load over it, and close it again."""
    with route.start(testbed), ExitStack() as stack:
        time.sleep(SETTLE_SECONDS)
        listen = [*route.listen_prefix(testbed), *_receiver(route, load)]
        receiver = _started(testbed, stack, listen)
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


def wait_until(when: int) -> int:
    """Sleep until `when` (ns); return how late it is already, ns."""
    left = when - time.monotonic_ns()
    if left > 0:
        time.sleep(left / _SECOND)
    return max(0, -left)


class LatencyRecorder:
    """The messages that a receiver got, one by one."""

    def __init__(self, topics: set[str], count: int) -> None:
        self.latencies: list[int] = []
        self.sequences: list[int] = []
        self.disordered = 0
        self.count = count
        self._silent_topics = topics

    def warm(self, topic: str) -> None:
        """Note a message of a topic; print `ready` once every topic had one."""
        if topic in self._silent_topics:
            self._silent_topics.remove(topic)
            if not self._silent_topics:
                print("ready", flush=True)

    def result(self) -> dict[str, object]:
        """Return all as JSON."""
        return {
            "latencies_ns": self.latencies,
            "sequences": self.sequences,
            "disordered": self.disordered,
        }
