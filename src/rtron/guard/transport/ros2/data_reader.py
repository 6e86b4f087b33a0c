"""One DDS reader of the guard: raw messages with their publishers' GIDs."""

from __future__ import annotations

import logging
import math
from abc import ABC, abstractmethod
from functools import partial
from time import time_ns
from typing import TYPE_CHECKING

from rclpy.qos import DurabilityPolicy, HistoryPolicy

from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.system.process_attributes import exit_out_of_memory
from rtron.guard.transport.common.protocol import NumberedMessage
from rtron.guard.transport.ros2.delivery import LatenessDetector
from rtron.guard.transport.ros2.qos import (
    HANDOVER_S,
    KEEP_ALL_DEPTH,
    fitting_depth,
    most_size,
    profile,
    with_depth,
)
from rtron.guard.transport.ros2.rcl import EventFd
from rtron.vocabulary import QoS, Ros2ActionEntity, ros2_entity_name
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    from rtron.guard.transport.ros2.context import TransportContext


log = logging.getLogger(__name__)

_DEPTH = 10


class DataListener(ABC):
    """Whom a reader's messages are for."""

    @abstractmethod
    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> bool:
        """Take a message, its publisher's GID, and its DDS sequence number if there is one.

        Return whether the message counts: a stranger's does not.
        """

    def note_late(self, reader: DataReader, gid: bytes, number: int | None) -> None:  # noqa: B027
        """Note a message that is dropped since it is late."""

    def note_replaced(self, count: int) -> None:  # noqa: B027 - most need not know
        """Note how many messages newer ones replaced in the reader before they were taken."""


class FeedbackReader(DataListener):
    """Passes on each feedback message of an action, whoever sends it.

    SourceError if the action's type is not installed.
    """

    def __init__(
        self,
        node: Node,
        action: str,
        type: str,
        context: TransportContext,
        on_feedback: Callable[[bytes], None],
    ) -> None:
        self._on_feedback = on_feedback
        cls = find_interface(type).cls
        self._reader = DataReader(
            node,
            cls.Impl.FeedbackMessage,  # type: ignore[attr-defined]
            ros2_entity_name(action, Ros2ActionEntity.FEEDBACK),
            profile(QoS(), _DEPTH),
            context,
            self,
            is_command=False,
        )

    def close(self) -> None:
        """Read no more."""
        self._reader.close()

    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> bool:
        """Pass on a message; see `DataListener`."""
        del reader, gid, number
        self._on_feedback(message)
        return True


try:
    from rclpy.event_handler import SubscriptionEventCallbacks
except ImportError:  # Humble
    from rclpy.qos_event import SubscriptionEventCallbacks


_MAX_BYTES = 1 << 20
"""What is taken at a time: more of it would keep commands waiting."""


class _Queue:
    """What DDS keeps of a topic for us, and an eventfd that counts what arrives."""

    def __init__(
        self,
        node: Node,
        cls: type,
        topic: str,
        profile: QoSProfile,
        context: TransportContext,
        on_count: Callable[[_Queue, int], int],
    ) -> None:
        self._node = node
        self._subscription = node.create_subscription(
            cls,
            topic,
            lambda _message: None,
            profile,
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
        )
        self.pointer: int = self._subscription.handle.pointer
        self._event_fd = EventFd(context.loop, partial(on_count, self))
        context.rcl.notify("subscription", self._subscription.handle, self._event_fd.fd)

    def close(self) -> None:
        if self.pointer:
            self.pointer = 0
            self._node.destroy_subscription(self._subscription)
            self._event_fd.stop()


class DataReader:
    """Reads publishers of one QoS, with `profile`.

    Transient-local messages get their numbers, since DDS sends them again to every new reader;
    where the RMW has none, the time at which they were sent. Messages of an `is_command` reader
    are dropped if they are late. Fewer messages wait where they turn out to be large; while that
    changes (`is_changing`), some come twice.
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
        self._rcl = context.rcl
        self._listener = listener
        self._topic = topic
        self._loop = context.loop
        self._now = context.loop.now
        self.begin = 0
        """How many bytes of each message are taken, 0 for all."""
        self._lateness = LatenessDetector() if is_command else None
        self._log_throttle = LogThrottle()
        self._adds_numbers = profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
        self._profile = profile
        is_unlimited = profile.history is HistoryPolicy.KEEP_ALL
        self._most_size = most_size(KEEP_ALL_DEPTH if is_unlimited else profile.depth)
        self._create_queue = partial(_Queue, node, cls, topic)
        self._queue = self._create_queue(profile, context, self._on_count)
        self._former: _Queue | None = None
        self._context = context

    @property
    def is_changing(self) -> bool:
        """Whether the same messages may come twice now."""
        return self._former is not None

    def close(self) -> None:
        """Stop reading."""
        self._close_former(self._former)
        self._queue.close()

    def _on_count(self, queue: _Queue, count: int) -> int:
        """Take some messages, fewer of large ones; return how many are left to take."""
        size = 0
        if self._former and queue is not self._former:
            size = self._empty(self._former, _MAX_BYTES)
        while count and size < _MAX_BYTES:
            if not self._take_next(queue):
                if queue is self._queue:
                    self._listener.note_replaced(count)
                return 0
            count, size = count - 1, size + self._rcl.size
        return count

    def _empty(self, former: _Queue, limit: float) -> int:
        """Take what came before the messages of another queue, until `limit` bytes; return them."""
        size = 0
        while size < limit and self._take_next(former):
            size += self._rcl.size
        return size

    def _take_next(self, queue: _Queue) -> bool:
        """Take a message, and pass it on unless it is late; return whether there was one."""
        message_and_gid = self._rcl.take(queue.pointer, self.begin) if queue.pointer else None
        if message_and_gid is None:
            return False
        message, gid = message_and_gid
        if self._lateness and self._is_late(self._lateness, gid):
            self._listener.note_late(self, gid, self._rcl.sequence_number)
        else:
            self._deliver(gid, self._numbered(gid, message) if self._adds_numbers else message)
        return True

    def _make_room(self, size: int) -> None:
        """Let fewer messages wait: they have `size` bytes.

        The former queue serves until the publishers know the new one.
        """
        depth = fitting_depth(size)
        self._most_size = most_size(depth)
        log.info("%s: messages of %d bytes: %d wait for the guard", self._topic, size, depth)
        self._close_former(self._former)
        self._former = self._queue
        profile = with_depth(self._profile, depth)
        self._queue = self._create_queue(profile, self._context, self._on_count)
        self._loop.call_later(HANDOVER_S, partial(self._close_former, self._former))

    def _close_former(self, former: _Queue | None) -> None:
        """Take what is left in the former queue, and close it; nothing if it is another one.

        It is closed whatever fails, so that the change has an end.
        """
        if former and former is self._former:
            try:
                self._empty(former, math.inf)
            finally:
                former.close()
                self._former = None if self._former is former else self._former

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
        size = self._rcl.size
        try:
            counts = self._listener.take(self, gid, message, self._rcl.sequence_number)
        except MemoryError:
            exit_out_of_memory()
        except Exception:
            log.exception("internal error, a message is dropped")
        else:
            if counts and size > self._most_size:
                self._make_room(size)
