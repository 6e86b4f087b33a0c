"""One run of generator and receiver over a way, and many runs over several ways, interleaved."""

import json
import subprocess
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from bench.common.testbed import Site, complaints, end, python, start
from bench.part import Say
from bench.ros1.routes import Way


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
class Run:
    """What came of a run; `late_ms` is how far the generator fell behind its schedule."""

    latencies_ns: tuple[int, ...]
    sequences: tuple[int, ...]
    disordered: int
    lost: int
    late_ms: float
    seconds: float


def run(here: Site, way: Way, load: Load) -> Run:
    """Open a way, send a load over it, and close it again."""
    with way.open(here), ExitStack() as stack:
        receiver = _started(here, stack, _receiver(way, load))
        generator = _started(here, stack, _generator(way, load))
        _expect_ready(here, way, receiver)
        sent = _result(here, way, _say(generator, "go"))
        came = _result(here, way, _say(receiver, "the end"))
        _finish(generator)
    return Run(
        latencies_ns=tuple(came["latencies_ns"]),
        sequences=tuple(came["sequences"]),
        disordered=came["disordered"],
        lost=load.arriving - len(set(came["sequences"])),
        late_ms=sent["late_ms"],
        seconds=sent["seconds"],
    )


def interleave(
    here: Site, ways: Sequence[Way], load: Load, runs: int, say: Say
) -> dict[str, list[Run]]:
    """Run every way `runs` times, in turn, so that what disturbs one disturbs all."""
    found: dict[str, list[Run]] = {way.name: [] for way in ways}
    for number in range(1, runs + 1):
        for way in ways:
            say(f"{way.name}, run {number} of {runs}")
            found[way.name].append(run(here, way, load))
    return found


def _receiver(way: Way, load: Load) -> list[str]:
    options = ("--count", str(load.arriving), "--message", load.message)
    limit = ("--limit", str(load.limit))
    return python(way.end("receiver"), "--subscribe", *way.outputs, *options, *limit)


def _generator(way: Way, load: Load) -> list[str]:
    options = ("--count", str(load.count), "--message", load.message, "--limit", str(load.limit))
    pace = ("--rate", str(load.rate), "--burst", str(load.burst))
    return python(way.end("generator"), "--publish", *way.inputs, *options, *pace)


def _started(here: Site, stack: ExitStack, command: list[str]) -> subprocess.Popen[str]:
    process = start(here, command, piped=True)
    stack.callback(end, process)
    return process


def _expect_ready(here: Site, way: Way, receiver: subprocess.Popen[str]) -> None:
    if not receiver.stdout or receiver.stdout.readline() != "ready\n":
        raise TimeoutError(f"{way.name}: not every topic is heard\n{complaints(here)}")


def _say(process: subprocess.Popen[str], line: str) -> str:
    """Say a line to a process and return its next one; empty if it ended."""
    if not process.stdin or not process.stdout:
        raise ValueError("the process is not piped")
    try:
        process.stdin.write(line + "\n")
        process.stdin.flush()
    except BrokenPipeError:
        pass  # a receiver that has all it waits for does not listen any more
    return process.stdout.readline()


def _result(here: Site, way: Way, line: str) -> dict[str, Any]:
    if not line:
        raise TimeoutError(f"{way.name}: a process gave up\n{complaints(here)}")
    result: dict[str, Any] = json.loads(line)
    return result


def _finish(process: subprocess.Popen[str]) -> None:
    """Let a process take back its registrations."""
    _say(process, "the end")
    process.wait()
