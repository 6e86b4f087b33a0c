"""RTron's own place in a ROS 2 domain: a context, and nodes with nothing that was not asked for.

The domain, the range of discovery and the RMW are those of the environment (`ROS_DOMAIN_ID`,
`ROS_AUTOMATIC_DISCOVERY_RANGE` or `ROS_LOCALHOST_ONLY`, `RMW_IMPLEMENTATION`), unless told.
"""

from __future__ import annotations

import uuid
from contextlib import nullcontext

import rclpy
from rclpy.context import Context
from rclpy.node import Node

from rtron.errors import SourceError
from rtron.vocabulary import PRIVATE_ROOT
from rtron.wire.ros2.discovery_tuning import large_receive_buffers
from rtron.wire.ros2.domain_id import domain_id
from rtron.wire.ros2.endpoints import await_publishers
from rtron.wire.ros2.interfaces import find_interface


class Ros2Session:
    """One participant of the domain; `close` ends it with all of its nodes.

    InputError if there is no such domain.
    """

    def __init__(self, domain: int | None = None) -> None:
        self.domain = domain_id(domain)
        self.context = Context()
        self.context.init(args=[], domain_id=self.domain)
        self._nodes: dict[str, Node] = {}

    def node(self, name: str) -> Node:
        """Return our node of this full name; ROS 2's own remaps do not reach it.

        The first one opens the participant.
        """
        if name not in self._nodes:
            space, _, base = name.rpartition("/")
            with nullcontext() if self._nodes else large_receive_buffers():
                self._nodes[name] = self._create_node(base, space)
        return self._nodes[name]

    def _create_node(self, base: str, space: str) -> Node:
        return Node(
            base,
            context=self.context,
            namespace=space or "/",
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )

    def destroy_node(self, name: str) -> None:
        """Take a node out of the graph."""
        node = self._nodes.pop(name, None)
        if node:
            node.destroy_node()

    def participant(self, name: str) -> bytes:
        """Return which participant our node `name` is in; SourceError if the RMW does not tell.

        It is seen at a publisher whose topic nobody else can know.
        """
        node, topic = self.node(name), f"{PRIVATE_ROOT}/self_{uuid.uuid4().hex}"
        publisher = node.create_publisher(find_interface("std_msgs/Empty").cls, topic, 1)
        try:
            found = {each.participant for each in await_publishers(node, topic, 1)}
        finally:
            node.destroy_publisher(publisher)
        if len(found) != 1:
            raise SourceError("this RMW does not tell which endpoints are ours", help="use a DDS")
        return found.pop()

    def close(self) -> None:
        """Leave the domain."""
        for name in list(self._nodes):
            self.destroy_node(name)
        self.context.try_shutdown()


def rmw_identifier() -> str:
    """Return which RMW the environment has chosen, for example `rmw_fastrtps_cpp`."""
    return str(rclpy.get_rmw_implementation_identifier())
