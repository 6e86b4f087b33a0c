"""One DDS reader of the guard: raw messages with their publishers' GIDs, as they come in."""

from __future__ import annotations

import logging
from time import time_ns
from typing import TYPE_CHECKING

from rclpy.event_handler import SubscriptionEventCallbacks

from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.out_of_memory import end_starved
from rtron.guard.transport.numbered import Numbered
from rtron.guard.transport.ros2.event_fd import Bell
from rtron.guard.transport.ros2.lateness import Lateness
from rtron.guard.transport.ros2.qos import asked_for
from rtron.vocabulary import Durability

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.transport.ros2.context import Surroundings
    from rtron.vocabulary import QoS

    Heard = Callable[["Reader", bytes, bytes], None]

log = logging.getLogger(__name__)


class Reader:
    """Asks for what publishers of one QoS offer; `heard` gets the reader, the GID, the message.

    What publishers keep comes numbered: DDS tells it again to every new reader. What is
    `momentary` is not handed on late.
    """

    def __init__(
        self,
        node: Node,
        cls: type,
        topic: str,
        qos: QoS,
        shared: Surroundings,
        heard: Heard,
        *,
        momentary: bool,
    ) -> None:
        self._node = node
        self._rcl = shared.rcl
        self._heard = heard
        self._topic = topic
        self._now = shared.loop.now
        self._lateness = Lateness() if momentary else None
        self._seldom = Seldom()
        self._numbers = qos.durability is Durability.TRANSIENT_LOCAL
        self._subscription = node.create_subscription(
            cls,
            topic,
            lambda _message: None,
            asked_for(qos),
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
        )
        self._pointer: int = self._subscription.handle.pointer
        self._bell = Bell(shared.loop, self._take)
        self._rcl.notify("subscription", self._subscription.handle, self._bell.fd)

    def close(self) -> None:
        """Read no more."""
        self._pointer = 0
        self._node.destroy_subscription(self._subscription)
        self._bell.silence()

    def _take(self, count: int) -> None:
        for _ in range(count):
            taken = self._rcl.take(self._pointer) if self._pointer else None
            if taken is None:
                return
            message, gid = taken
            if self._lateness and self._is_late(self._lateness, gid):
                continue
            self._hand_on(gid, self._numbered(gid, message) if self._numbers else message)

    def _numbered(self, gid: bytes, message: bytes) -> bytes:
        number = self._rcl.number
        if number is None:
            return message
        return Numbered.of(message, gid.hex(), number, self._rcl.said)

    def _is_late(self, lateness: Lateness, gid: bytes) -> bool:
        if not lateness.is_late(gid, self._rcl.said, time_ns(), self._now):
            return False
        if self._seldom.may_say("late", self._now()):
            log.warning("%s: what comes late is dropped: it was meant for the moment", self._topic)
        return True

    def _hand_on(self, gid: bytes, message: bytes) -> None:
        """Hand a message on; one that fails must not leave those behind it unread."""
        try:
            self._heard(self, gid, message)
        except MemoryError:
            end_starved()
        except Exception:
            log.exception("internal error, a message is dropped")
