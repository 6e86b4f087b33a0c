"""Who offers and who calls a service, as the domain tells it: types and GIDs.

The graph API knows a service's ends by node name only, which is not unique. In DDS a service is two
topics (ROS 2 design: Topic and Service name mapping to DDS), so its ends have GIDs as others have.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, gid_of, node_name
from rtron.wire.ros2.service_names import reply_topic, request_topic

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo

_TYPE = re.compile(r"(\w+)::(srv|action)::dds_::(\w+)_(?:Request|Response)_", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2ServiceEndpoint:
    """A node's end of a service; `node` is its full name, "" while the domain has not told it.

    `type` is in ROS 2's spelling, `gid` that of the writer, b"" where the RMW is no DDS.
    """

    service: str
    is_server: bool
    node: str
    type: str
    gid: bytes

    @property
    def participant(self) -> bytes:
        """The participant that the end belongs to."""
        return self.gid[:PARTICIPANT_SIZE]


def servers_of(node: Node, service: str) -> list[Ros2ServiceEndpoint]:
    """Return who offers a service now; nobody where the RMW is no DDS."""
    replies = node.get_publishers_info_by_topic(reply_topic(service), no_mangle=True)
    return list(_service_endpoints(service, replies, is_server=True))


def clients_of(node: Node, service: str) -> list[Ros2ServiceEndpoint]:
    """Return who can call a service now; nobody where the RMW is no DDS."""
    requests = node.get_publishers_info_by_topic(request_topic(service), no_mangle=True)
    return list(_service_endpoints(service, requests, is_server=False))


def service_endpoints_of_node(node: Node, base: str, space: str) -> list[Ros2ServiceEndpoint]:
    """Return the ends of a node by its name, on any RMW; of doubles, one's.

    RuntimeError or ValueError if there is no such node any more, or the name is none.
    """
    offered = node.get_service_names_and_types_by_node(base, space)
    called = node.get_client_names_and_types_by_node(base, space)
    name = node_name(base, space)
    return [
        Ros2ServiceEndpoint(service=service, is_server=serves, node=name, type=type, gid=b"")
        for serves, services in ((True, offered), (False, called))
        for service, types in services
        for type in types
    ]


def _service_endpoints(
    service: str, infos: Iterable[TopicEndpointInfo], *, is_server: bool
) -> Iterator[Ros2ServiceEndpoint]:
    for info in infos:
        yield Ros2ServiceEndpoint(
            service=service,
            is_server=is_server,
            node=node_name(info.node_name, info.node_namespace),
            type=_type(info.topic_type),
            gid=gid_of(info),
        )


def _type(dds_type: str) -> str:
    """Return the service's type for that of its request or response, as DDS or ROS spell it."""
    found = _TYPE.fullmatch(dds_type)
    return f"{found[1]}/{found[2]}/{found[3]}" if found else dds_type
