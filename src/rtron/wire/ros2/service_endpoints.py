"""Who offers and who calls a service, as the domain tells it: types and GIDs.

The graph API knows a service's ends by node name only, which is not unique. In DDS a service is two
topics (ROS 2 design: Topic and Service name mapping to DDS), so its ends have GIDs as others have.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.wire.ros2.endpoints import PARTICIPANT, gid_of, node_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo

_TYPE = re.compile(r"(\w+)::(srv|action)::dds_::(\w+)_(?:Request|Response)_", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2ServiceEnd:
    """A node's end of a service; `node` is its full name, "" while the domain has not told it.

    `type` is in ROS 2's spelling, `gid` that of the writer, b"" where the RMW is no DDS.
    """

    service: str
    serves: bool
    node: str
    type: str
    gid: bytes

    @property
    def participant(self) -> bytes:
        """The participant that the end belongs to."""
        return self.gid[:PARTICIPANT]


def replies_of(service: str) -> str:
    """Return DDS's name of the topic on which a service is answered."""
    return f"rr{service}Reply"


def servers_of(node: Node, service: str) -> list[Ros2ServiceEnd]:
    """Return who offers a service now; nobody where the RMW is no DDS."""
    replies = node.get_publishers_info_by_topic(replies_of(service), no_mangle=True)
    return list(_ends(service, replies, serves=True))


def clients_of(node: Node, service: str) -> list[Ros2ServiceEnd]:
    """Return who can call a service now; nobody where the RMW is no DDS."""
    requests = node.get_publishers_info_by_topic(f"rq{service}Request", no_mangle=True)
    return list(_ends(service, requests, serves=False))


def ends_by_node(node: Node, base: str, space: str) -> list[Ros2ServiceEnd]:
    """Return the ends of a node by its name, on any RMW; of doubles, one's.

    RuntimeError or ValueError if there is no such node any more, or the name is none.
    """
    offered = node.get_service_names_and_types_by_node(base, space)
    called = node.get_client_names_and_types_by_node(base, space)
    name = node_name(base, space)
    return [
        Ros2ServiceEnd(service=service, serves=serves, node=name, type=type, gid=b"")
        for serves, services in ((True, offered), (False, called))
        for service, types in services
        for type in types
    ]


def _ends(
    service: str, infos: Iterable[TopicEndpointInfo], *, serves: bool
) -> Iterator[Ros2ServiceEnd]:
    for info in infos:
        yield Ros2ServiceEnd(
            service=service,
            serves=serves,
            node=node_name(info.node_name, info.node_namespace),
            type=_type(info.topic_type),
            gid=gid_of(info),
        )


def _type(told: str) -> str:
    """Return the service's type for that of its request or response, as DDS or ROS spell it."""
    found = _TYPE.fullmatch(told)
    return f"{found[1]}/{found[2]}/{found[3]}" if found else told
