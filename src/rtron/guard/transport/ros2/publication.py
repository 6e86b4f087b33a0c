"""A topic that one of our nodes publishes, with the QoS of those whose words it carries.

What DDS keeps for late subscribers, it keeps of a writer as a whole, and it tells them without
asking. So each flow whose last word is kept has a writer of its own, where no other flow pushes it
out. The writer of all other words must offer transient local too where a driver asks for it, but
keeps what it has said for a moment only: an old command would move a driver that comes back.
"""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.transport.common.backlog import Backlog
from rtron.guard.transport.ros2.qos import command_qos, latched, profile, strongest
from rtron.vocabulary import SECOND, Durability, QoS, matches_node, normalise_type
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    from rtron.guard.transport.common.protocol import TypeInfo
    from rtron.guard.transport.ros2.context import TransportContext
    from rtron.guard.transport.ros2.rcl import Rcl
    from rtron.wire.ros2.endpoints import Ros2Endpoint


class Writer:
    """`publish` sends a message, `count` tells how many subscribers it is matched with."""

    def __init__(self, node: Node, cls: type, topic: str, offered: QoSProfile, rcl: Rcl) -> None:
        self._node = node
        self._publisher = node.create_publisher(cls, topic, offered)
        handle = self._publisher.handle
        self.publish: Callable[[bytes], None] = partial(rcl.publish, handle.pointer)
        self.count: Callable[[], int] = handle.get_subscription_count

    def close(self) -> None:
        """Leave the topic; what was kept goes too."""
        self._node.destroy_publisher(self._publisher)


log = logging.getLogger(__name__)

_EARLY_TIMEOUT = SECOND
_EARLY_TIMEOUT_LATCHED = 5 * SECOND
"""A publisher that keeps what it says, says it once; on a busy machine names take seconds."""
_EARLY_BYTES = 1 << 20


class Publication:
    """Publishes raw messages; its writers are made when the type and the QoS are known.

    They are made again when flows offer more than they do. What is said before the first of the
    expected `successors` is there waits for it a moment, in its order, the stop behind the command.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        type: str,
        context: TransportContext,
        *,
        queue_size: int,
        successors: tuple[str, ...] = (),
    ) -> None:
        self.topic = topic
        self.internal_readers = 0
        """How many subscribers are only there to be seen, and need no messages."""
        self.type = normalise_type(type)
        self.info: TypeInfo | None = None
        self._node = node
        self._graph = context.graph
        self._rcl = context.rcl
        self._depth = queue_size
        self._successors = successors
        self._matched_successors: tuple[str, ...] = ()
        self._owners = context.owners
        self._offered: dict[str, QoS] = {}
        self._qos = QoS()
        self._writer: Writer | None = None
        self._latched: dict[str, bytes] = {}
        self._latched_writers: dict[str, Writer] = {}
        self._early: Backlog | None = None
        self._early_since = 0
        self._now = context.loop.now
        self._graph.watch(topic)
        self._graph.listeners.append(self._flush)

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if another is known or the name differs."""
        if self.info is not None:
            return self.info.md5sum == info.md5sum and self.info.type == info.type
        name = normalise_type(info.type)
        if self.type not in ("", name) or self._requested_types() - {name}:
            return False
        self.info = info
        return True

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer at least what a flow's publisher offers."""
        if self._offered.get(flow) == qos:
            return
        self._offered[flow] = qos
        required = strongest(self._offered.values())
        if self._writer is None or required != self._qos:
            self._log_qos(required)
            self._create_writers(required)

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer from now on what these ask for; see `Output`."""
        self._matched_successors = successors
        self._graph.listeners.append(self._offer_to_successors)

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; keep it for late ones as the last word of `latched_by`."""
        if latched_by is not None:
            self._publish_latched(message, latched_by)
            return
        writer = self._writer or self._create_writers(self._qos)
        if self._early is not None and self._must_wait(self._early):
            self._early.append(message)
        elif self._successors or writer.count() > self.internal_readers:
            writer.publish(message)

    def is_subscribed_by(self, node: str) -> bool:
        """Tell whether a node of that name subscribes."""
        return any(each.node == node for each in self._graph.endpoints(self.topic).subscribers)

    def clear_latched(self) -> None:
        """Keep nothing for late subscribers any more."""
        self._early = None
        self._latched.clear()
        self._close_latched_writers()

    def close(self) -> None:
        """Publish no more."""
        self._close_latched_writers()
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def _offer_to_successors(self) -> None:
        subscribers = self._subscribers_named(self._matched_successors)
        requested = [
            end.qos for end in subscribers if self._owners.is_owner(end.node, end.participant)
        ]
        if requested:
            self.offer("listeners", strongest(requested))

    def _subscribers_named(self, nodes: tuple[str, ...]) -> list[Ros2Endpoint]:
        """Return the subscribers that have one of these names."""
        subscribers = self._graph.endpoints(self.topic).subscribers
        return [end for end in subscribers if any(matches_node(each, end.node) for each in nodes)]

    def _requested_types(self) -> set[str]:
        """Return the types that successors ask for."""
        return {normalise_type(each.type) for each in self._subscribers_named(self._successors)}

    def _create_writers(self, qos: QoS) -> Writer:
        """Make the writers, and let them know what late subscribers are to get."""
        self.close()
        self._qos = qos
        self._writer = self._create_writer(command_qos(qos), self._depth)
        if self._successors and self._early is None:
            self._early, self._early_since = Backlog(self._depth, _EARLY_BYTES), 0
        for latched_by, message in self._latched.items():
            self._latched_writer(latched_by).publish(message)
        return self._writer

    def _create_writer(self, qos: QoS, depth: int) -> Writer:
        cls = find_interface(self.info.type if self.info else self.type).cls
        return Writer(self._node, cls, self.topic, profile(qos, depth), self._rcl)

    def _publish_latched(self, message: bytes, latched_by: str) -> None:
        self._latched.pop(latched_by, None)
        self._latched[latched_by] = message
        self._latched_writer(latched_by).publish(message)

    def _latched_writer(self, latched_by: str) -> Writer:
        """Return the writer that keeps one last word."""
        if latched_by not in self._latched_writers:
            self._latched_writers[latched_by] = self._create_writer(latched(self._qos), 1)
        return self._latched_writers[latched_by]

    def _close_latched_writers(self) -> None:
        for writer in self._latched_writers.values():
            writer.close()
        self._latched_writers.clear()

    def _log_qos(self, offered: QoS) -> None:
        if len(set(self._offered.values())) > 1:
            text = "%s: its publishers differ in QoS; offered is what fits all: %s, %s"
            log.warning(text, self.topic, offered.reliability, offered.durability)

    def _must_wait(self, early: Backlog) -> bool:
        """Tell whether the first messages wait for a successor; when it is late, they are stale."""
        self._flush()
        if self._early is None:
            return False
        if not early:
            self._early_since = self._now()
        elif not self._is_fresh():
            self._early = None
        return self._early is not None

    def _flush(self) -> None:
        """Send what has waited, once a successor is there: a tool that listens is none."""
        if self._early is None or self._writer is None or not self._has_successor(self._writer):
            return
        early, self._early = self._early, None
        for _ in range(len(early) if self._is_fresh() else 0):
            self._writer.publish(early.pop())

    def _is_fresh(self) -> bool:
        """Tell whether what waits has not waited too long."""
        is_latched = self._qos.durability is Durability.TRANSIENT_LOCAL
        return self._now() - self._early_since <= (
            _EARLY_TIMEOUT_LATCHED if is_latched else _EARLY_TIMEOUT
        )

    def _has_successor(self, writer: Writer) -> bool:
        """Tell whether a successor listens, and is matched: whose reader is, DDS does not tell."""
        return (
            bool(self._subscribers_named(self._successors))
            and writer.count() > self.internal_readers
        )
