"""Many questions at once, and an end to the waiting whatever those asked do."""

import threading
import time
from collections.abc import Callable, Mapping
from queue import Empty, SimpleQueue
from typing import TypeVar

_T = TypeVar("_T")
_MAX_THREADS = 64


def run_with_deadline(jobs: Mapping[str, Callable[[], _T]], limit: float) -> dict[str, _T]:
    """Return the results of the jobs that end within `limit` seconds; jobs must not raise.

    A job that hangs (a name server that never answers cannot be timed out) keeps a daemon thread
    and nobody else.
    """
    pending: SimpleQueue[str] = SimpleQueue()
    done: SimpleQueue[tuple[str, _T]] = SimpleQueue()
    for name in jobs:
        pending.put(name)
    deadline = time.monotonic() + limit

    def work() -> None:
        while time.monotonic() < deadline:
            try:
                name = pending.get_nowait()
            except Empty:
                return
            done.put((name, jobs[name]()))

    for _ in range(min(_MAX_THREADS, len(jobs))):
        threading.Thread(target=work, daemon=True).start()
    return _collect(done, len(jobs), deadline)


def _collect(done: SimpleQueue[tuple[str, _T]], expected: int, deadline: float) -> dict[str, _T]:
    results: dict[str, _T] = {}
    while len(results) < expected:
        try:
            name, result = done.get(timeout=max(0.0, deadline - time.monotonic()))
        except Empty:
            break
        results[name] = result
    return results
