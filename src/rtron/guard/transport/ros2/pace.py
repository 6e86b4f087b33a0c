"""Answers at a pace: a client of ROS 2 keeps the ten newest that it has not read, by default."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import EventLoop

BURST_SIZE = 8
"""So many answers go at once, and so many more after each pause."""
PAUSE = SECOND // 50


class ResponsePacer:
    """Sends what it is given in order, a few at once: a crowd of answers would push out its own.

    Who cancels many goals gets as many results.
    """

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop
        self._queue: deque[Callable[[], None]] = deque()
        self._remaining = BURST_SIZE
        self._is_pausing = False

    def send(self, send: Callable[[], None]) -> None:
        """Call `send` as soon as its turn comes."""
        self._queue.append(send)
        self._send_next()

    def _send_next(self) -> None:
        while self._queue and self._remaining:
            self._remaining -= 1
            if not self._is_pausing:
                self._is_pausing = True
                self._loop.call_at(self._loop.now() + PAUSE, self._resume)
            self._queue.popleft()()

    def _resume(self) -> None:
        self._remaining, self._is_pausing = BURST_SIZE, False
        self._send_next()
