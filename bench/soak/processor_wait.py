"""How long guard and supervisor were ready and had to wait for a processor, from /proc."""

import time
from bisect import bisect_left
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread

from bench.soak.app import SoakedApp
from bench.soak.base_log import Span

_PERIOD_S = 0.02
_LOOK_S = 1.0


class ProcessorWait:
    """Samples it in a thread; a process that is stopped does not wait."""

    def __init__(self, app: SoakedApp) -> None:
        self._app = app
        self._times: list[int] = []
        self._waits: list[int] = []
        self._supervisors: list[int] = []
        self._look_due = 0.0
        self._ended = Event()
        self._thread = Thread(target=self._sample, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Sample no more."""
        self._ended.set()
        self._thread.join()

    def within(self, span: Span) -> int:
        """Return how long (ns) the two waited in a span, and up to two samples around it."""
        begin = max(0, bisect_left(self._times, span.at) - 1)
        end = bisect_left(self._times, span.at + span.length) + 1
        return sum(self._waits[begin + 1 : end])

    def _sample(self) -> None:
        """Note by how much the waits of both have grown."""
        before: dict[int, int] = {}
        while not self._ended.wait(_PERIOD_S):
            waits = dict(self._wait_times())
            self._times.append(time.monotonic_ns())
            self._waits.append(sum(now - before.get(pid, now) for pid, now in waits.items()))
            before = waits

    def _wait_times(self) -> Iterator[tuple[int, int]]:
        """Yield the process that guards and the one that supervises, each with its wait, ns."""
        for pid in (self._app.guard(), *self._known_supervisors()):
            with suppress(OSError):
                yield pid, int(Path(f"/proc/{pid}/schedstat").read_text().split()[1])

    def _known_supervisors(self) -> list[int]:
        """Return the supervisors; to look through all processes takes a while."""
        now = time.monotonic()
        if now >= self._look_due:
            self._look_due = now + _LOOK_S
            self._supervisors = self._app.pids("supervisor")
        return self._supervisors
