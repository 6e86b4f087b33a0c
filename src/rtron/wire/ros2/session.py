"""RTron's own place in a ROS 2 domain: a context, and nodes with nothing that was not asked for.

The domain, the range of discovery and the RMW are those of the environment (`ROS_DOMAIN_ID`,
`ROS_AUTOMATIC_DISCOVERY_RANGE` or `ROS_LOCALHOST_ONLY`, `RMW_IMPLEMENTATION`), unless told. So is
whether SROS2 is on, and with which keystore (`ROS_SECURITY_ENABLE`, `ROS_SECURITY_STRATEGY`,
`ROS_SECURITY_KEYSTORE`).
"""

from __future__ import annotations

import os
import uuid
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING

import rclpy
from rclpy.context import Context
from rclpy.node import Node

from rtron.errors import SourceError
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT
from rtron.wire.ros2.discovery_tuning import large_receive_buffers
from rtron.wire.ros2.domain_id import domain_id
from rtron.wire.ros2.endpoints import await_publishers
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from collections.abc import Iterator

_HELP = "look at ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE and RMW_IMPLEMENTATION"
_SECURITY_HELP = (
    "ROS_SECURITY_ENABLE is true: look at ROS_SECURITY_KEYSTORE, and run `rtron secure --diff`"
)


class Ros2Session:
    """One participant of the domain; `close` ends it with all of its nodes.

    Under SROS2 it has the identity of `enclave`. InputError if there is no such domain, SourceError
    if it cannot be joined.
    """

    def __init__(self, domain: int | None = None, enclave: str = GUARD_NODE) -> None:
        self.domain = domain_id(domain)
        self.context = Context()
        self._nodes: dict[str, Node] = {}
        with _as_source_error():
            self.context.init(args=["--ros-args", "--enclave", enclave], domain_id=self.domain)

    def node(self, name: str) -> Node:
        """Return our node of this full name; ROS 2's own remaps do not reach it.

        The first one opens the participant.
        """
        if name not in self._nodes:
            space, _, base = name.rpartition("/")
            tuning = nullcontext() if self._nodes else large_receive_buffers()
            with tuning, _as_source_error():
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


@contextmanager
def _as_source_error() -> Iterator[None]:
    """Say what to look at where ROS 2 cannot be joined."""
    try:
        yield
    except RuntimeError as error:
        is_secure = os.environ.get("ROS_SECURITY_ENABLE") == "true"
        help = _SECURITY_HELP if is_secure else _HELP
        raise SourceError(f"ROS 2 cannot be joined: {error}", help=help) from error


def rmw_identifier() -> str:
    """Return which RMW the environment has chosen, for example `rmw_fastrtps_cpp`."""
    return str(rclpy.get_rmw_implementation_identifier())
