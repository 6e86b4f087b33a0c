"""One DDS reader of the guard: raw messages with their publishers' GIDs."""

from __future__ import annotations

import logging
from time import time_ns
from typing import TYPE_CHECKING, Protocol

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy

from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.out_of_memory import exit_out_of_memory
from rtron.guard.transport.common.protocol import NumberedMessage
from rtron.guard.transport.ros2.delivery import LatenessDetector
from rtron.guard.transport.ros2.event_fd import EventFd

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    from rtron.guard.transport.ros2.context import TransportContext

log = logging.getLogger(__name__)

_MAX_BYTES = 1 << 20
"""What is taken at a time: more of it would keep commands waiting."""


class DataListener(Protocol):
    """Whom a reader's messages are for."""

    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> None:
        """Take a message, its publisher's GID, and its DDS sequence number if there is one."""
        ...

    def note_late(self, reader: DataReader, gid: bytes, number: int | None) -> None:
        """Note a message that is dropped since it is late."""
        ...

    def note_replaced(self, count: int) -> None:
        """Note how many messages newer ones replaced in the reader before they were taken."""
        ...


class DataReader:
    """Reads publishers of one QoS, with `profile`.

    Transient-local messages get their numbers, since DDS sends them again to every new reader;
    where the RMW has none, the time at which they were sent.
    Messages of an `is_command` reader are dropped if they are late.
    """

    def __init__(
        self,
        node: Node,
        cls: type,
        topic: str,
        profile: QoSProfile,
        context: TransportContext,
        listener: DataListener,
        *,
        is_command: bool,
    ) -> None:
        self._node = node
        self._rcl = context.rcl
        self._listener = listener
        self._topic = topic
        self._now = context.loop.now
        self.begin = 0
        """How many bytes of each message are taken, 0 for all."""
        self._lateness = LatenessDetector() if is_command else None
        self._log_throttle = LogThrottle()
        self._adds_numbers = profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
        self._subscription = node.create_subscription(
            cls,
            topic,
            lambda _message: None,
            profile,
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
        )
        self._pointer: int = self._subscription.handle.pointer
        self._event_fd = EventFd(context.loop, self._on_count)
        self._rcl.notify("subscription", self._subscription.handle, self._event_fd.fd)

    def close(self) -> None:
        """Stop reading."""
        self._pointer = 0
        self._node.destroy_subscription(self._subscription)
        self._event_fd.stop()

    def _on_count(self, count: int) -> int:
        """Take some messages, fewer of large ones; return how many are left to take."""
        size = 0
        while count and size < _MAX_BYTES:
            message_and_gid = self._rcl.take(self._pointer, self.begin) if self._pointer else None
            if message_and_gid is None:
                self._listener.note_replaced(count)
                return 0
            message, gid = message_and_gid
            count, size = count - 1, size + len(message)
            if self._lateness and self._is_late(self._lateness, gid):
                self._listener.note_late(self, gid, self._rcl.sequence_number)
            else:
                self._deliver(gid, self._numbered(gid, message) if self._adds_numbers else message)
        return count

    def _numbered(self, gid: bytes, message: bytes) -> bytes:
        """Return a message with its number, or with when it was sent: that grows, too."""
        number = self._rcl.sequence_number
        if number is None:
            number = self._rcl.source_time
        return NumberedMessage.of(message, gid.hex(), number, self._rcl.source_time)

    def _is_late(self, lateness: LatenessDetector, gid: bytes) -> bool:
        if not lateness.is_late(gid, self._rcl.source_time, time_ns(), self._now):
            return False
        if self._log_throttle.allows("late", self._now()):
            log.warning("%s: a late command is dropped", self._topic)
        return True

    def _deliver(self, gid: bytes, message: bytes) -> None:
        """Pass on a message; one that fails must not leave those behind it unread."""
        try:
            self._listener.take(self, gid, message, self._rcl.sequence_number)
        except MemoryError:
            exit_out_of_memory()
        except Exception:
            log.exception("internal error, a message is dropped")
