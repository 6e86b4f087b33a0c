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

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.protocol import MessageHandler, NumberedMessage
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

_MAX_PUBLISHERS = 64
_HISTORY_WINDOW = 10 * SECOND


class LatchedMessageFilter:
    """Knows the last goal of each latching publisher of a topic, this guard's and those before.

    By the publisher's name its digest, by the publisher's writer its number.
    """

    def __init__(self, topic: str, handover: HandoverState) -> None:
        self._topic = topic
        self._key = f"latched {topic}"
        self._handover = handover
        inherited = handover.inherited(self._key)
        self._last_marks: dict[str, object] = dict(inherited) if isinstance(inherited, dict) else {}

    def filter(self, node: str, take: MessageHandler) -> MessageHandler:
        """Return what takes the messages of a new connection, of those kept only what is new."""
        first, history_until = True, monotonic_ns() + _HISTORY_WINDOW

        def receive(message: bytes) -> None:
            nonlocal first, history_until
            is_first, first = first, False
            if is_first and self._has_numbers_of(message):
                history_until = 0
            is_new = self._is_new(node, message, is_first=is_first)
            if is_new and not (
                self._is_older_than_handover(message) and monotonic_ns() < history_until
            ):
                take(message)
            elif is_first:
                log.warning("%s: what %s has kept is old; it is dropped", self._topic, node)

        return receive

    def _has_numbers_of(self, message: bytes) -> bool:
        return isinstance(message, NumberedMessage) and message.writer in self._last_marks

    def _is_older_than_handover(self, message: bytes) -> bool:
        """Tell whether a message was said before the last guard was gone; False if nobody knows."""
        return (
            isinstance(message, NumberedMessage)
            and 0 < message.source_time <= self._handover.last_seen_at
        )

    def _is_new(self, node: str, message: bytes, *, is_first: bool) -> bool:
        """Tell whether a message comes for the first time, and remember it if so."""
        mark: int | str
        if isinstance(message, NumberedMessage):
            writer, mark = message.writer, message.number
            last = self._last_marks.get(writer)
            is_new = not isinstance(last, int) or mark > last
        else:
            writer, mark = node, blake2b(message, digest_size=16).hexdigest()
            is_new = not is_first or self._last_marks.get(writer) != mark
        if is_new:
            self._remember(writer, mark)
        return is_new

    def _remember(self, writer: str, mark: int | str) -> None:
        self._last_marks.pop(writer, None)
        self._last_marks[writer] = mark
        if len(self._last_marks) > _MAX_PUBLISHERS:
            self._last_marks.pop(next(iter(self._last_marks)))
        self._handover.store(self._key, self._last_marks)
