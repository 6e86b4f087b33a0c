"""DDS writers of raw messages: what waits in them for slow readers is bounded in bytes."""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING

from rclpy.duration import Duration

from rtron.errors import WireError
from rtron.guard.transport.ros2.qos import HANDOVER_S, fitting_depth, most_size
from rtron.vocabulary.plan import MAX_QUEUE_BYTES

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.rcl import Rcl

log = logging.getLogger(__name__)

_MAX_WAITS = 10
"""How often a change of writers waits another `HANDOVER_S`."""


class Writer:
    """A DDS writer: `publish` sends a message, `count` returns the number of matched readers.

    `lost` counts what was not sent. rcl does not tell what a newer message has replaced.
    """

    def __init__(self, node: Node, cls: type, topic: str, offered: QoSProfile, rcl: Rcl) -> None:
        self.topic = topic
        self._node = node
        self._publisher = node.create_publisher(cls, topic, offered)
        handle = self._publisher.handle
        self.publish: Callable[[bytes], None] = partial(rcl.publish, handle.pointer)
        self.count: Callable[[], int] = handle.get_subscription_count
        self.lost = 0

    def is_taken(self) -> bool:
        """Return whether the reliable readers have all that was sent."""
        return bool(self._publisher.wait_for_all_acked(Duration()))

    def close(self) -> None:
        """Leave the topic; the messages that DDS keeps go too."""
        self._node.destroy_publisher(self._publisher)


class LosslessWriter(Writer):
    """A DDS writer that keeps all messages until the reliable readers have them.

    What a slow reader leaves no room for is not sent, and counted. A publisher with a full history
    refuses a message at once; see `publishes_without_waiting`.
    """

    def __init__(self, node: Node, cls: type, topic: str, offered: QoSProfile, rcl: Rcl) -> None:
        super().__init__(node, cls, topic, offered, rcl)
        self._send = self.publish
        self.publish = self._publish
        self._unacknowledged = 0

    def _publish(self, message: bytes) -> None:
        if not self._has_room():
            self.lost += 1
            return
        try:
            self._send(message)
        except WireError:
            self.lost += 1
        else:
            self._unacknowledged += len(message)

    def _has_room(self) -> bool:
        """Tell whether another message may wait.

        Whether the readers have all is asked from half of the bound on: one that keeps up seldom
        has the last message at the very moment of asking, but often enough before the bound.
        """
        is_much = self._unacknowledged > MAX_QUEUE_BYTES // 2
        if is_much and self.is_taken():
            self._unacknowledged = 0
        return self._unacknowledged <= MAX_QUEUE_BYTES


class FittingWriter:
    """A writer in which fewer messages wait when these turn out to be large.

    The former writer serves until the readers know the next one, and stays a moment longer for
    those that have not taken all. Of large messages the newest count: not all are kept any more.
    """

    def __init__(
        self, first: Writer, depth: int, create: Callable[[int], Writer], loop: EventLoop
    ) -> None:
        """`create` makes a writer that keeps the last so many messages; `first` keeps `depth`."""
        self._writer = first
        self._next: Writer | None = None
        self._former: Writer | None = None
        self._most_size = most_size(depth)
        self._create = create
        self._loop = loop
        self._lost = 0

    @property
    def lost(self) -> int:
        """How many messages were not sent."""
        return self._lost + self._writer.lost

    def count(self) -> int:
        """Return the number of matched readers."""
        return self._writer.count()

    def publish(self, message: bytes) -> None:
        """Send a message."""
        if len(message) > self._most_size:
            self._make_room(len(message))
        if self._next and self._next.count() >= self._writer.count():
            self._switch(self._next)
        self._writer.publish(message)

    def close(self) -> None:
        """Leave the topic."""
        self._close_former(self._former)
        for writer in (self._next, self._writer):
            if writer:
                writer.close()
        self._next = None

    def _make_room(self, size: int) -> None:
        depth = fitting_depth(size)
        self._most_size = most_size(depth)
        log.info("%s: messages of %d bytes: %d may wait", self._writer.topic, size, depth)
        if self._next:
            self._next.close()
        self._next = self._create(depth)
        self._loop.call_later(HANDOVER_S, partial(self._switch_in_time, self._next, _MAX_WAITS))

    def _switch_in_time(self, next: Writer, waits: int) -> None:
        """Switch when the readers know the next writer; on a busy machine that takes a while."""
        if next is not self._next:
            return
        if waits and next.count() < self._writer.count():
            retry = partial(self._switch_in_time, next, waits - 1)
            self._loop.call_later(HANDOVER_S, retry)
        else:
            self._switch(next)

    def _switch(self, next: Writer) -> None:
        """Send with the next writer from now on."""
        self._close_former(self._former)
        self._former, self._writer, self._next = self._writer, next, None
        self._lost += self._former.lost
        close = partial(self._close_former_in_time, self._former, _MAX_WAITS)
        self._loop.call_later(HANDOVER_S, close)

    def _close_former_in_time(self, former: Writer, waits: int) -> None:
        """Close the former writer when the reliable readers have all that it sent."""
        if former is not self._former:
            return
        if waits and not former.is_taken():
            retry = partial(self._close_former_in_time, former, waits - 1)
            self._loop.call_later(HANDOVER_S, retry)
        else:
            self._close_former(former)

    def _close_former(self, former: Writer | None) -> None:
        if former and former is self._former:
            former.close()
            self._former = None
