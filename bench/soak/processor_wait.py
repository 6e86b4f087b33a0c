"""How long the guard's process was ready and had to wait for a processor, from /proc."""

import time
from bisect import bisect_left
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread

from bench.soak.app import SoakedApp
from bench.soak.base_log import Span

_PERIOD_S = 0.02


class ProcessorWait:
    """Samples it in a thread; a process that is stopped does not wait."""

    def __init__(self, app: SoakedApp) -> None:
        self._app = app
        self._times: list[int] = []
        self._waits: list[int] = []
        self._ended = Event()
        self._thread = Thread(target=self._sample, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Sample no more."""
        self._ended.set()
        self._thread.join()

    def within(self, span: Span) -> int:
        """Return how long (ns) the guard waited in a span, and up to two samples around it."""
        begin = max(0, bisect_left(self._times, span.at) - 1)
        end = bisect_left(self._times, span.at + span.length) + 1
        return sum(self._waits[begin + 1 : end])

    def _sample(self) -> None:
        """Note by how much the wait of the process that guards has grown."""
        known: dict[int, int] = {}
        while not self._ended.wait(_PERIOD_S):
            with suppress(OSError, IndexError):
                pid = self._app.guard()
                wait = int(Path(f"/proc/{pid}/schedstat").read_text().split()[1])
                self._times.append(time.monotonic_ns())
                self._waits.append(wait - known.get(pid, wait))
                known[pid] = wait
