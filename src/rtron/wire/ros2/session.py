"""RTron's own place in a ROS 2 domain: a context, and nodes with nothing that was not asked for.

The domain, the range of discovery and the RMW are those of the environment (`ROS_DOMAIN_ID`,
`ROS_AUTOMATIC_DISCOVERY_RANGE` or `ROS_LOCALHOST_ONLY`, `RMW_IMPLEMENTATION`), unless told.
"""

from __future__ import annotations

from rclpy.context import Context
from rclpy.node import Node


class Session:
    """One participant of the domain; `close` ends it with all of its nodes."""

    def __init__(self, domain: int | None = None) -> None:
        self.context = Context()
        self.context.init(args=[], domain_id=domain)
        self._nodes: dict[str, Node] = {}

    def node(self, name: str) -> Node:
        """Return our node of this full name; ROS 2's own remaps do not reach it."""
        if name not in self._nodes:
            space, _, base = name.rpartition("/")
            self._nodes[name] = Node(
                base,
                context=self.context,
                namespace=space or "/",
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
        return self._nodes[name]

    def drop(self, name: str) -> None:
        """Take a node out of the graph."""
        node = self._nodes.pop(name, None)
        if node:
            node.destroy_node()

    def close(self) -> None:
        """Leave the domain."""
        for name in list(self._nodes):
            self.drop(name)
        self.context.try_shutdown()
