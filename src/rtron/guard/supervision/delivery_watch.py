"""Whether what goes into the guard comes out again: the supervisor's pings take a command's way.

That is the middleware, the guard's loop, and the middleware again.
"""

import logging
import secrets
import struct

from rtron.guard.core.report_messages import UINT64
from rtron.guard.supervision.watchdog import Watchdog
from rtron.guard.transport.common.protocol import (
    DEFAULT_INPUT,
    MessageHandler,
    Output,
    OutputOptions,
    Peer,
    Transport,
)
from rtron.messages.common.encoding import PREFIX
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT, SECOND, SUPERVISOR_NODE

log = logging.getLogger(__name__)

PING_PERIOD = SECOND // 20
"""The time between two pings, ns."""
PING_TOPIC = f"{PRIVATE_ROOT}/ping"
ECHO_TOPIC = f"{PRIVATE_ROOT}/echo"
_UNKNOWN_AFTER = 30 * SECOND
_NUMBER = struct.Struct("<Q")


class DeliveryWatch:
    """Sends pings through the guard, and tells how long none has come back."""

    def __init__(self, transport: Transport, now: int) -> None:
        self._encoding = transport.encoding
        self._output = _advertise(transport, SUPERVISOR_NODE, PING_TOPIC)
        _subscribe(transport, SUPERVISOR_NODE, ECHO_TOPIC, GUARD_NODE, self._on_echo)
        self._sent = secrets.randbits(32) << 31
        self._ping_due = now
        self.reset(now)

    def reset(self, now: int) -> None:
        """Watch another guard, which is not connected yet."""
        self._first = self._returned = self._sent
        self._watchdog = Watchdog(now)
        self._began_at = now
        self.is_unwatched = False
        """Whether no ping has come back long after the guard began: nobody knows if it delivers."""

    @property
    def is_known(self) -> bool:
        """Whether a ping has come back: before, the guard may not be connected yet."""
        return self._returned != self._first

    def tick(self, now: int) -> int:
        """Send what is due; return how long (ns) no ping has come back, 0 while nothing is known.

        Time in which nobody looked counts for little, as everywhere (`Watchdog`).
        """
        if now >= self._ping_due:
            self._ping_due = now + PING_PERIOD
            self._sent += 1
            self._output.publish(self._encoding.prefix(_NUMBER.size) + _NUMBER.pack(self._sent))
        if not self.is_known and not self.is_unwatched and now - self._began_at > _UNKNOWN_AFTER:
            self.is_unwatched = True
            log.error("no ping has come back through the guard: its delivery is not watched")
        silence = self._watchdog.update(now, self._returned)
        return silence if self.is_known else 0

    def _on_echo(self, message: bytes) -> None:
        if len(message) == PREFIX + _NUMBER.size:
            (number,) = _NUMBER.unpack_from(message, PREFIX)
            if self._returned < number <= self._sent:
                self._note_returned(number)

    def _note_returned(self, number: int) -> None:
        if not self.is_known:
            self.is_unwatched = False
            log.info("pings come back through the guard: its delivery is watched")
        self._returned = number


class DeliveryEcho:
    """Sends the supervisor's pings back from the guard."""

    def __init__(self, transport: Transport) -> None:
        self._transport = transport

    def open(self) -> None:
        """Send them back from now on."""
        output = _advertise(self._transport, GUARD_NODE, ECHO_TOPIC)
        _subscribe(self._transport, GUARD_NODE, PING_TOPIC, SUPERVISOR_NODE, output.publish)

    def close(self) -> None:
        """Send no more; the topics end with the transport."""


def _advertise(transport: Transport, node: str, topic: str) -> Output:
    output = transport.advertise(node, topic, UINT64.type, OutputOptions(queue_size=1))
    output.learn_type(UINT64)
    return output


def _subscribe(
    transport: Transport, node: str, topic: str, publisher: str, handler: MessageHandler
) -> None:
    """Take messages from one node and from nobody else."""

    def connect(peer: Peer) -> MessageHandler | None:
        is_readable = peer.info.md5sum == UINT64.md5sum
        return handler if is_readable and peer.verified and peer.node == publisher else None

    transport.subscribe(node, topic, UINT64.type, connect, DEFAULT_INPUT)
