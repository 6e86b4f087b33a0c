"""One DDS writer of the guard: raw messages, to whoever fits."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.qos import QoSProfile

    from rtron.guard.transport.ros2.rcl import Rcl


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
