"""A topic that one of our nodes publishes, with the QoS of the publishers that it forwards.

DDS keeps messages for late subscribers by writer, and sends them on its own. So each latched flow
has a writer of its own, where no other flow displaces its last message. The writer of all other
messages must offer transient local too, where a driver requests it, but keeps messages for a moment
only: an old command would move a driver that comes back.
"""

from __future__ import annotations

import logging
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.transport.common.backlog import Backlog
from rtron.guard.transport.ros2.qos import command_qos, latched, profile, strongest
from rtron.guard.transport.ros2.writer import FittingWriter, LosslessWriter, Writer
from rtron.vocabulary import SECOND, Durability, QoS, Reliability, matches_node, normalise_type
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from rclpy.node import Node

    from rtron.guard.transport.common.protocol import Greeting, OutputOptions, TypeInfo
    from rtron.guard.transport.ros2.context import TransportContext
    from rtron.wire.ros2.endpoints import Ros2Endpoint


log = logging.getLogger(__name__)

_MAX_CHANGES = 8
"""How often each flow may have the writer made again: it names a few QoS, one after the other."""
_EARLY_TIMEOUT = SECOND
_EARLY_TIMEOUT_LATCHED = 5 * SECOND
"""A latching publisher may send only once, and on a busy machine names take seconds."""
_EARLY_BYTES = 1 << 20


class Publication:
    """Publishes raw messages; it creates its writers when the type and the QoS are known.

    It creates them again when flows offer more QoS. Messages before the first of the expected
    `successors` wait for it a moment, in their order: a stop behind its command.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        type: str,
        context: TransportContext,
        options: OutputOptions,
    ) -> None:
        self.topic = topic
        self.internal_readers = 0
        """The number of our own subscribers, which are only for show and need no messages."""
        self.type = normalise_type(type)
        self.info: TypeInfo | None = None
        self._node = node
        self._graph = context.graph
        self._rcl = context.rcl
        self._depth, self._keep_all = options.queue_size, options.keep_all
        self._lost = 0
        self._successors = options.successors
        self._matched_successors: tuple[str, ...] = ()
        self._owners = context.owners
        self._offered: dict[str, QoS] = {}
        self._qos = QoS()
        self._changes: Counter[str] = Counter()
        self._writer: FittingWriter | None = None
        self._latched: dict[str, bytes] = {}
        self._latched_writers: dict[str, Writer] = {}
        self._early: Backlog | None = None
        self._early_since = 0
        self._loop = context.loop
        self._now = context.loop.now
        self._greeting: Greeting = lambda: None
        self._greeted_count = 0
        self._graph.watch(topic)
        self._graph.listeners.append(self._flush)

    @property
    def lost(self) -> int:
        """How many messages a reliable subscriber was too slow for."""
        return self._lost + (self._writer.lost if self._writer else 0)

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
        """Offer at least what a flow's publisher offers, and what was offered before.

        A new writer costs the successors a moment, so a publisher brings few of them about.
        """
        if self._offered.get(flow) == qos:
            return
        before = [self._qos] if self._offered else []
        self._offered[flow] = qos
        required = strongest([*before, *self._offered.values()])
        if self._writer is None:
            self._create_writers(required)
        elif required != self._qos:
            self._strengthen(flow, required)

    def _strengthen(self, flow: str, required: QoS) -> None:
        self._changes[flow] += 1
        if self._changes[flow] <= _MAX_CHANGES:
            self._log_qos(required)
            self._create_writers(required)
        elif self._changes[flow] == _MAX_CHANGES + 1:
            log.error(
                "%s: %s changes its QoS again and again, and is not followed", self.topic, flow
            )

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer the QoS that these nodes request from now on; see `Output`."""
        self._matched_successors = successors
        self._graph.listeners.append(self._offer_to_successors)

    def greet(self, greeting: Greeting) -> None:
        """Send the message of `greeting` when there is a new subscriber; see `Output`."""
        self._greeting = greeting
        self._graph.listeners.append(self._greet_new_readers)

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; latch it for late ones as the last message of `latched_by`."""
        if latched_by is not None:
            self._publish_latched(message, latched_by)
            return
        writer = self._writer or self._create_writers(self._qos)
        if self._early is not None and self._must_wait(self._early):
            self._early.append(message)
        elif self._successors or writer.count() > self.internal_readers:
            writer.publish(message)

    def is_subscribed_by(self, node: str) -> bool:
        """Return whether a node of that name subscribes."""
        return any(each.node == node for each in self._graph.endpoints(self.topic).subscribers)

    def clear_latched(self) -> None:
        """Latch no message for late subscribers any more."""
        self._early = None
        self._latched.clear()
        self._close_latched_writers()

    def close(self) -> None:
        """Stop publishing."""
        self._close_latched_writers()
        if self._writer is not None:
            self._lost += self._writer.lost
            self._writer.close()
            self._writer = None

    def is_of(self, node: str, topic: str) -> bool:
        """Return whether this is a topic of a node of ours."""
        return self.topic == topic and self._node.get_fully_qualified_name() == node

    def leave(self) -> None:
        """Stop publishing, and hear no more of the graph."""
        self.close()
        self._graph.listeners.remove(self._flush)

    def _offer_to_successors(self) -> None:
        subscribers = self._subscribers_named(self._matched_successors)
        requested = [
            each.qos for each in subscribers if self._owners.is_owner(each.node, each.participant)
        ]
        if requested:
            self.offer("listeners", strongest(requested))

    def _greet_new_readers(self) -> None:
        """Send the greeting if more readers are matched than before."""
        count = self._writer.count() if self._writer else 0
        before, self._greeted_count = self._greeted_count, count
        message = self._greeting() if count > before else None
        if message is not None and self._writer:
            self._writer.publish(message)

    def _subscribers_named(self, nodes: tuple[str, ...]) -> list[Ros2Endpoint]:
        """Return the subscribers that have one of these names."""
        return [
            endpoint
            for endpoint in self._graph.endpoints(self.topic).subscribers
            if any(matches_node(each, endpoint.node) for each in nodes)
        ]

    def _requested_types(self) -> set[str]:
        """Return the types that successors request."""
        return {normalise_type(each.type) for each in self._subscribers_named(self._successors)}

    def _create_writers(self, qos: QoS) -> FittingWriter:
        """Create the writers, and publish the latched messages with them."""
        self.close()
        self._qos = qos
        self._writer = self._create_main_writer(command_qos(qos))
        if self._successors and self._early is None:
            self._early, self._early_since = Backlog(self._depth, _EARLY_BYTES), 0
        for latched_by, message in self._latched.items():
            self._latched_writer(latched_by).publish(message)
        return self._writer

    def _create_main_writer(self, qos: QoS) -> FittingWriter:
        """Return the writer of what is not latched; one that is transient local would fill up."""
        is_reliable = qos.reliability is Reliability.RELIABLE
        is_volatile = qos.durability is Durability.VOLATILE
        if self._keep_all and is_reliable and is_volatile:
            offered = profile(qos, self._depth, keep_all=True)
            first: Writer = LosslessWriter(self._node, self._cls, self.topic, offered, self._rcl)
        else:
            first = self._create_writer(qos, self._depth)
        return FittingWriter(first, self._depth, partial(self._create_writer, qos), self._loop)

    def _create_writer(self, qos: QoS, depth: int) -> Writer:
        return Writer(self._node, self._cls, self.topic, profile(qos, depth), self._rcl)

    @property
    def _cls(self) -> type:
        return find_interface(self.info.type if self.info else self.type).cls

    def _publish_latched(self, message: bytes, latched_by: str) -> None:
        self._latched.pop(latched_by, None)
        self._latched[latched_by] = message
        self._latched_writer(latched_by).publish(message)

    def _latched_writer(self, latched_by: str) -> Writer:
        """Return the writer of one latched message."""
        if latched_by not in self._latched_writers:
            self._latched_writers[latched_by] = self._create_writer(latched(self._qos), 1)
        return self._latched_writers[latched_by]

    def _close_latched_writers(self) -> None:
        for writer in self._latched_writers.values():
            writer.close()
        self._latched_writers.clear()

    def _log_qos(self, offered: QoS) -> None:
        if len(set(self._offered.values())) > 1:
            text = "%s: its publishers differ in QoS; the guard offers what fits all: %s, %s"
            log.warning(text, self.topic, offered.reliability, offered.durability)

    def _must_wait(self, early: Backlog) -> bool:
        """Return whether a message waits for the first successor; after a time it is stale."""
        self._flush()
        if self._early is None:
            return False
        if not early:
            self._early_since = self._now()
        elif not self._is_fresh():
            self._early = None
        return self._early is not None

    def _flush(self) -> None:
        """Send the messages that wait, once a successor is there; a tool does not count."""
        if self._early is None or self._writer is None or not self._has_successor(self._writer):
            return
        early, self._early = self._early, None
        self._lost += early.dropped
        for _ in range(len(early) if self._is_fresh() else 0):
            self._writer.publish(early.pop())

    def _is_fresh(self) -> bool:
        """Return whether the messages that wait are not stale yet."""
        is_latched = self._qos.durability is Durability.TRANSIENT_LOCAL
        return self._now() - self._early_since <= (
            _EARLY_TIMEOUT_LATCHED if is_latched else _EARLY_TIMEOUT
        )

    def _has_successor(self, writer: FittingWriter) -> bool:
        """Return whether a successor subscribes and readers are matched; DDS hides which ones."""
        return (
            bool(self._subscribers_named(self._successors))
            and writer.count() > self.internal_readers
        )
