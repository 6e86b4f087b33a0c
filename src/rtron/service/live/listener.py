"""One console that listens to what is live; what it does not take in time ends it, not us."""

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from typing import Any

LiveMessage = dict[str, Any]
"""A live message, as JSON has it."""

MAX_QUEUED = 2000
"""So many live messages wait for a listener; with one more it is closed."""


class Listener:
    """An async iterator of live messages; it ends when it is closed, or was too slow.

    Made in the event loop that iterates over it; everything else may come from any thread.
    """

    def __init__(self, on_close: Callable[["Listener"], None]) -> None:
        self._loop = asyncio.get_running_loop()
        self._wake = asyncio.Event()
        self._queue: deque[LiveMessage] = deque()
        self._lock = Lock()
        self._is_closed = False
        self._on_close = on_close

    def put(self, message: LiveMessage) -> None:
        """Add a message; one too many closes the listener."""
        with self._lock:
            self._queue.append(message)
            was_empty, is_full = len(self._queue) == 1, len(self._queue) > MAX_QUEUED
        if is_full:
            self.close()
        elif was_empty:
            self._wake_loop()

    def close(self) -> None:
        """End the iteration at once; what waited is forgotten."""
        self._on_close(self)
        with self._lock:
            self._is_closed = True
            self._queue.clear()
        self._wake_loop()

    def __aiter__(self) -> "Listener":
        return self

    async def __anext__(self) -> LiveMessage:
        while True:
            self._wake.clear()
            with self._lock:
                if self._is_closed:
                    raise StopAsyncIteration
                if self._queue:
                    return self._queue.popleft()
            await self._wake.wait()

    def __enter__(self) -> "Listener":  # noqa: PYI034 - Self is not in Python 3.10
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def _wake_loop(self) -> None:
        with suppress(RuntimeError):  # its loop has ended
            self._loop.call_soon_threadsafe(self._wake.set)
