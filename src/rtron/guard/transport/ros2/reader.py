"""One DDS reader of the guard: raw messages with their publishers' GIDs, as they come in."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from rclpy.event_handler import SubscriptionEventCallbacks

from rtron.guard.starvation import end_starved
from rtron.guard.transport.numbered import Numbered
from rtron.guard.transport.ros2.bell import Bell
from rtron.guard.transport.ros2.qos import asked_for
from rtron.vocabulary import Durability

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.loop import Loop
    from rtron.guard.transport.ros2.rcl import Rcl
    from rtron.vocabulary import QoS

    Heard = Callable[["Reader", bytes, bytes], None]

log = logging.getLogger(__name__)


class Reader:
    """Asks for what publishers of one QoS offer; `heard` gets the reader, the GID, the message.

    What publishers keep comes numbered: DDS tells it again to every new reader.
    """

    def __init__(
        self, node: Node, cls: type, topic: str, qos: QoS, rcl: Rcl, loop: Loop, heard: Heard
    ) -> None:
        self._node = node
        self._rcl = rcl
        self._heard = heard
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
        self._bell = Bell(loop, self._take)
        rcl.notify("subscription", self._subscription.handle, self._bell.fd)

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
            self._hand_on(gid, self._numbered(gid, message) if self._numbers else message)

    def _numbered(self, gid: bytes, message: bytes) -> bytes:
        number = self._rcl.number
        return message if number is None else Numbered.of(message, gid.hex(), number)

    def _hand_on(self, gid: bytes, message: bytes) -> None:
        """Hand a message on; one that fails must not leave those behind it unread."""
        try:
            self._heard(self, gid, message)
        except MemoryError:
            end_starved()
        except Exception:
            log.exception("internal error, a message is dropped")
