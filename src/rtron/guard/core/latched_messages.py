"""Latched goals: each new connection brings them again, and they count only once.

The next guard must know the last ones too, so they are part of the handover state.

ROS 1: a publisher latches its last message and does not say when it sent it. The guard compares the
first message of a new connection with the last one it knows.

ROS 2: a publisher keeps any number of messages, and DDS numbers them. A message is old if its
number is not above the highest one received from that publisher. Neither clocks nor contents
matter: a goal that is sent twice counts twice, also while no guard runs.

After a restart of the whole app no numbers are left, but the last heartbeat of the guard before is.
A message whose DDS source timestamp is not after that heartbeat is old. A publisher whose clock is
slow must still get through, so this holds only for messages that arrive as a connection begins, as
latched ones do. Where numbers are left, they alone count: the guard before may have been killed
before it received the message.
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
    """Knows the last message of each latching publisher of a topic, also from guards before.

    It is a digest by the publisher's name (ROS 1), or a number by its writer (ROS 2).
    """

    def __init__(self, topic: str, handover: HandoverState) -> None:
        self._topic = topic
        self._key = f"latched {topic}"
        self._handover = handover
        inherited = handover.inherited(self._key)
        self._last_marks: dict[str, object] = dict(inherited) if isinstance(inherited, dict) else {}

    def filter(self, node: str, take: MessageHandler) -> MessageHandler:
        """Return a handler for a new connection that drops latched messages which are not new."""
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
                log.warning(
                    "%s: latched message of %s was already handled: dropped", self._topic, node
                )

        return receive

    def _has_numbers_of(self, message: bytes) -> bool:
        return isinstance(message, NumberedMessage) and message.writer in self._last_marks

    def _is_older_than_handover(self, message: bytes) -> bool:
        """Return whether a message was sent before the last guard ended; False if unknown."""
        return (
            isinstance(message, NumberedMessage)
            and 0 < message.source_time <= self._handover.last_seen_at
        )

    def _is_new(self, node: str, message: bytes, *, is_first: bool) -> bool:
        """Return whether a message comes for the first time, and remember it if so."""
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
