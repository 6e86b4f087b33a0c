"""Many questions at once, and an end to the waiting whatever those asked do."""

import threading
import time
from collections.abc import Callable, Mapping
from queue import Empty, SimpleQueue
from typing import TypeVar

_T = TypeVar("_T")
_THREADS = 64


def in_time(jobs: Mapping[str, Callable[[], _T]], limit: float) -> dict[str, _T]:
    """Return the results of the jobs that end within `limit` seconds; jobs must not raise.

    A job that hangs (a name server that never answers cannot be timed out) keeps a daemon thread
    and nobody else.
    """
    waiting: SimpleQueue[str] = SimpleQueue()
    done: SimpleQueue[tuple[str, _T]] = SimpleQueue()
    for name in jobs:
        waiting.put(name)
    end = time.monotonic() + limit

    def work() -> None:
        while time.monotonic() < end:
            try:
                name = waiting.get_nowait()
            except Empty:
                return
            done.put((name, jobs[name]()))

    for _ in range(min(_THREADS, len(jobs))):
        threading.Thread(target=work, daemon=True).start()
    return _collected(done, len(jobs), end)


def _collected(done: SimpleQueue[tuple[str, _T]], expected: int, end: float) -> dict[str, _T]:
    found: dict[str, _T] = {}
    while len(found) < expected:
        try:
            name, result = done.get(timeout=max(0.0, end - time.monotonic()))
        except Empty:
            break
        found[name] = result
    return found
