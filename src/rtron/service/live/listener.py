"""One console that listens to what is live; what it does not take in time ends it, not us."""

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from typing import Any

Live = dict[str, Any]
"""A live message, as JSON has it."""

MOST_WAITING = 2000
"""So many live messages wait for a listener; with one more it is closed."""


class Listener:
    """An async iterator of live messages; it ends when it is closed, or was too slow.

    Made in the event loop that iterates over it; everything else may come from any thread.
    """

    def __init__(self, forget: Callable[["Listener"], None]) -> None:
        self._loop = asyncio.get_running_loop()
        self._wake = asyncio.Event()
        self._waiting: deque[Live] = deque()
        self._lock = Lock()
        self._closed = False
        self._forget = forget

    def put(self, live: Live) -> None:
        """Add a message; one too many closes the listener."""
        with self._lock:
            self._waiting.append(live)
            first, full = len(self._waiting) == 1, len(self._waiting) > MOST_WAITING
        if full:
            self.close()
        elif first:
            self._rouse()

    def close(self) -> None:
        """End the iteration at once; what waited is forgotten."""
        self._forget(self)
        with self._lock:
            self._closed = True
            self._waiting.clear()
        self._rouse()

    def __aiter__(self) -> "Listener":
        return self

    async def __anext__(self) -> Live:
        while True:
            self._wake.clear()
            with self._lock:
                if self._closed:
                    raise StopAsyncIteration
                if self._waiting:
                    return self._waiting.popleft()
            await self._wake.wait()

    def __enter__(self) -> "Listener":  # noqa: PYI034 - Self is not in Python 3.10
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def _rouse(self) -> None:
        with suppress(RuntimeError):  # its loop has ended
            self._loop.call_soon_threadsafe(self._wake.set)
