"""Answers at a pace: a client of ROS 2 keeps the ten newest that it has not read, by default."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import Loop

AT_ONCE = 8
"""So many answers go at once, and so many more after each pause."""
PAUSE = SECOND // 50


class Pace:
    """Sends what it is given in order, a few at once: a crowd of answers would push out its own.

    Who cancels many goals gets as many results.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._waiting: deque[Callable[[], None]] = deque()
        self._left = AT_ONCE
        self._pausing = False

    def send(self, answer: Callable[[], None]) -> None:
        """Call `answer` as soon as its turn comes."""
        self._waiting.append(answer)
        self._go_on()

    def _go_on(self) -> None:
        while self._waiting and self._left:
            self._left -= 1
            if not self._pausing:
                self._pausing = True
                self._loop.call_at(self._loop.now() + PAUSE, self._resume)
            self._waiting.popleft()()

    def _resume(self) -> None:
        self._left, self._pausing = AT_ONCE, False
        self._go_on()
