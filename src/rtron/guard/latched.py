"""Latched goals: what a publisher has kept comes again over each new connection, to be done once.

Also the next guard must know it. In ROS 1 a publisher keeps its last word, which is compared with
the first of a new connection: a publisher says nothing of when it said it. In ROS 2 it keeps as
many as it likes, and DDS gives each a number, which it has still when it comes again: what is not
above the highest number that was heard of that publisher is old. Neither clocks nor what a message
says matter to that: a goal that is given twice counts twice, also while no guard was there.
"""

import logging
from hashlib import blake2b

from rtron.guard.transport.numbered import Numbered
from rtron.guard.transport.transport import Receive
from rtron.guard.will import Will

log = logging.getLogger(__name__)

_MOST = 64


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
        first = True

        def receive(message: bytes) -> None:
            nonlocal first
            is_first, first = first, False
            if self._is_new(node, message, is_first=is_first):
                take(message)
            elif is_first:
                log.warning("%s: %s is connected again; what it has kept is old", self._topic, node)

        return receive

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
