"""Latched goals and commands: what is kept comes again over each new connection, to be done once.

Also the next guard must know it. In ROS 1 a publisher keeps its last word, which is compared with
the first of a new connection: a publisher says nothing of when it said it. In ROS 2 it keeps as
many as it likes, and DDS gives each a number, which it has still when it comes again: what is not
above the highest number that was heard of that publisher is old. Neither clocks nor what a message
says matter to that: a goal that is given twice counts twice, also while no guard was there.

What was said while the guard before was there is not done either: after a restart of the whole no
numbers are left, but the time of its last sign of life is. This goes by DDS's time of when it was
said. A publisher whose clock is slow shall be heard all the same, so only what comes as a
connection begins, as what was kept does, is held against it. Where its numbers are left, they alone
count: a guard may have been there, and killed before it had heard what was said.
"""

import logging
from hashlib import blake2b
from time import monotonic_ns

from rtron.guard.core.handover_state import Will
from rtron.guard.transport.common.protocol import Receive
from rtron.guard.transport.numbered import Numbered
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

_MOST = 64
_HISTORY_COMES = 10 * SECOND


class Latched:
    """Knows the last goal of each latching publisher of a topic, this guard's and those before.

    By the publisher's name its digest, by the publisher's writer its number.
    """

    def __init__(self, topic: str, will: Will) -> None:
        self._topic = topic
        self._key = f"latched {topic}"
        self._will = will
        found = will.found(self._key)
        self._last: dict[str, object] = dict(found) if isinstance(found, dict) else {}

    def once(self, node: str, take: Receive) -> Receive:
        """Return what takes the messages of a new connection, of those kept only what is new."""
        first, history_until = True, monotonic_ns() + _HISTORY_COMES

        def receive(message: bytes) -> None:
            nonlocal first, history_until
            is_first, first = first, False
            if is_first and self._has_numbers_of(message):
                history_until = 0
            is_new = self._is_new(node, message, is_first=is_first)
            if is_new and not (self._is_from_before(message) and monotonic_ns() < history_until):
                take(message)
            elif is_first:
                log.warning("%s: what %s has kept is old; it is dropped", self._topic, node)

        return receive

    def _has_numbers_of(self, message: bytes) -> bool:
        return isinstance(message, Numbered) and message.writer in self._last

    def _is_from_before(self, message: bytes) -> bool:
        """Tell whether a message was said before the last guard was gone; False if nobody knows."""
        return isinstance(message, Numbered) and 0 < message.said <= self._will.left_at

    def _is_new(self, node: str, message: bytes, *, is_first: bool) -> bool:
        """Tell whether a message comes for the first time, and remember it if so."""
        mark: int | str
        if isinstance(message, Numbered):
            writer, mark = message.writer, message.number
            last = self._last.get(writer)
            is_new = not isinstance(last, int) or mark > last
        else:
            writer, mark = node, blake2b(message, digest_size=16).hexdigest()
            is_new = not is_first or self._last.get(writer) != mark
        if is_new:
            self._remember(writer, mark)
        return is_new

    def _remember(self, writer: str, mark: int | str) -> None:
        self._last.pop(writer, None)
        self._last[writer] = mark
        if len(self._last) > _MOST:
            self._last.pop(next(iter(self._last)))
        self._will.keep(self._key, self._last)
