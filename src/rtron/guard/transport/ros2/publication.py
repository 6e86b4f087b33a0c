"""A topic that one of our nodes publishes, with the QoS of those whose words it carries."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from rtron.guard.transport.backlog import Backlog
from rtron.guard.transport.ros2.qos import profile, strongest
from rtron.vocabulary import SECOND, Durability, QoS, normalise_type
from rtron.wire.ros2.interfaces import interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.transport.ros2.surroundings import Surroundings
    from rtron.guard.transport.transport import TypeInfo

log = logging.getLogger(__name__)

_AWAIT_FIRST = SECOND
_EARLY_BYTES = 1 << 20
_STATE = QoS(durability=Durability.TRANSIENT_LOCAL)


class Publication:
    """Publishes raw messages; the publisher is made when the type and the QoS are known.

    It is made again when flows offer more than it does. What is said before the first of the
    expected `successors` has found it waits for that a moment.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        type: str,
        shared: Surroundings,
        *,
        queue_size: int,
        successors: tuple[str, ...] = (),
    ) -> None:
        self.topic = topic
        self.own_readers = 0
        """How many subscribers are only there to be seen, and need no messages."""
        self.type = normalise_type(type)
        self.info: TypeInfo | None = None
        self._node = node
        self._graph = shared.graph
        self._rcl = shared.rcl
        self._depth = queue_size
        self._successors = successors
        self._offered: dict[str, QoS] = {}
        self._latched: dict[str, bytes] = {}
        self._publisher: Any = None
        self._pointer = 0
        self._count: Callable[[], int] = lambda: 0
        self._qos = QoS()
        self._early: Backlog | None = None
        self._early_since = 0
        self._now = shared.loop.now
        self._graph.watch(topic)
        self._graph.changed.append(self._flush)

    def learn(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if another is known or the name differs."""
        if self.info is not None:
            return self.info.md5sum == info.md5sum and self.info.type == info.type
        name = normalise_type(info.type)
        if self.type not in ("", name) or self._asked_for() - {name}:
            return False
        self.info = info
        return True

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer at least what a flow's publisher offers."""
        if self._offered.get(flow) == qos:
            return
        self._offered[flow] = qos
        wanted = strongest(self._offered.values())
        keeps_each = wanted.durability is Durability.TRANSIENT_LOCAL
        if self._publisher is None or wanted != self._qos or keeps_each:
            self._report(wanted)
            self._make(wanted)

    def suit_listeners(self) -> None:
        """Offer from now on what all who listen ask for: a stop must reach every one of them."""
        self._graph.changed.append(self._suit)

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; keep it for late ones as the last word of `latched_by`."""
        if latched_by is not None:
            self._latched.pop(latched_by, None)
            self._latched[latched_by] = message
        if self._publisher is None:
            self._make(_STATE if latched_by is not None else QoS())
            if latched_by is not None:
                return
        self._send(message)

    def reaches(self, node: str) -> bool:
        """Tell whether a node of that name subscribes."""
        return any(each.node == node for each in self._graph.ends(self.topic).subscribers)

    def forget(self) -> None:
        """Keep nothing for late subscribers any more."""
        self._latched.clear()
        self._early = None
        if self._publisher is not None and self._qos.durability is Durability.TRANSIENT_LOCAL:
            self._make(self._qos)

    def close(self) -> None:
        """Publish no more."""
        if self._publisher is not None:
            self._node.destroy_publisher(self._publisher)
            self._publisher = None

    def _suit(self) -> None:
        asked = [each.qos for each in self._graph.ends(self.topic).subscribers]
        if asked:
            self.offer("listeners", strongest(asked))

    def _send(self, message: bytes) -> None:
        if self._count() > self.own_readers:
            self._flush()
        elif self._qos.durability is Durability.VOLATILE:
            self._keep(message)
            return
        self._rcl.publish(self._pointer, message)

    def _asked_for(self) -> set[str]:
        """Return the types that successors ask for."""
        listening = self._graph.ends(self.topic).subscribers
        return {normalise_type(each.type) for each in listening if each.node in self._successors}

    def _make(self, qos: QoS) -> None:
        """Make the publisher, and let it know what late subscribers are to get."""
        found = interface(self.info.type if self.info else self.type)
        self.close()
        self._qos = qos
        kept = qos.durability is Durability.TRANSIENT_LOCAL
        depth = max(1, len(self._offered)) if kept else self._depth
        made = self._node.create_publisher(found.cls, self.topic, profile(qos, depth))
        self._publisher, self._pointer = made, made.handle.pointer
        self._count = made.handle.get_subscription_count
        if self._successors and self._early is None:
            self._early, self._early_since = Backlog(self._depth, _EARLY_BYTES), 0
        for message in self._latched.values() if kept else ():
            self._rcl.publish(self._pointer, message)

    def _report(self, wanted: QoS) -> None:
        if len(set(self._offered.values())) > 1:
            told = "%s: its publishers differ in QoS; offered is what fits all: %s, %s"
            log.warning(told, self.topic, wanted.reliability, wanted.durability)

    def _keep(self, message: bytes) -> None:
        """Let the first messages wait for a successor; when it is late, they are stale."""
        if self._early is None:
            return
        self._early_since = self._early_since or self._now()
        if self._now() - self._early_since > _AWAIT_FIRST:
            self._early = None
        else:
            self._early.append(message)

    def _flush(self) -> None:
        """Send what has waited, once somebody is there."""
        if self._early is not None and self._publisher is not None and self._count():
            early, self._early = self._early, None
            fresh = self._now() - self._early_since <= _AWAIT_FIRST
            for _ in range(len(early) if fresh else 0):
                self._rcl.publish(self._pointer, early.pop())
