"""Who publishes and subscribes a topic, as the domain tells it: types, QoS and GIDs.

A GID is an endpoint's own; its first 12 bytes are its participant's (OMG DDSI-RTPS 2.5, 8.2.4).
Node names are not unique in ROS 2, GIDs are.

The graph API knows a service's ends by node name only, which is not unique. In DDS a service is two
topics (ROS 2 design: Topic and Service name mapping to DDS), so its ends have GIDs as others have.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rclpy.qos import DurabilityPolicy, LivelinessPolicy, ReliabilityPolicy

from rtron.vocabulary import Direction, Durability, Liveliness, QoS, Reliability
from rtron.wire.ros2.c_structures import GID_SIZE
from rtron.wire.ros2.service_names import reply_topic, request_topic

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rclpy.duration import Duration
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.topic_endpoint_info import TopicEndpointInfo

PARTICIPANT_SIZE = 12
"""How many bytes of a GID name the participant."""
_UNKNOWN = "_NODE_NAME_UNKNOWN_"
_INFINITE = 1 << 62
_TIMEOUT_S = 5.0
_POLL_S = 0.001


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2Endpoint:
    """An endpoint of a topic; `node` is its full name, "" while the domain has not told it.

    `type` is in ROS 2's spelling, `type_hash` its REP 2016 hash, "" where there is none.
    """

    topic: str
    direction: Direction
    node: str
    type: str
    type_hash: str
    gid: bytes
    qos: QoS

    @property
    def participant(self) -> bytes:
        """The participant that the endpoint belongs to."""
        return self.gid[:PARTICIPANT_SIZE]


def publishers_of(node: Node, topic: str) -> list[Ros2Endpoint]:
    """Return who publishes a topic now."""
    return _endpoints(topic, Direction.PUBLISH, node.get_publishers_info_by_topic(topic))


def await_publishers(node: Node, topic: str, count: int) -> list[Ros2Endpoint]:
    """Return who publishes a topic, once they are so many, at the latest after 5 s.

    Of an endpoint of this process, too, Cyclone DDS tells only in a moment.
    """
    until = time.monotonic() + _TIMEOUT_S
    while len(found := publishers_of(node, topic)) < count and time.monotonic() < until:
        time.sleep(_POLL_S)
    return found


def subscribers_of(node: Node, topic: str) -> list[Ros2Endpoint]:
    """Return who subscribes a topic now."""
    return _endpoints(topic, Direction.SUBSCRIBE, node.get_subscriptions_info_by_topic(topic))


def _endpoints(
    topic: str, direction: Direction, infos: Iterable[TopicEndpointInfo]
) -> list[Ros2Endpoint]:
    return [
        Ros2Endpoint(
            topic=topic,
            direction=direction,
            node=node_name(info.node_name, info.node_namespace),
            type=info.topic_type,
            type_hash=_type_hash(info),
            gid=gid_of(info),
            qos=qos_of(info.qos_profile),
        )
        for info in infos
    ]


def node_name(base: str, space: str) -> str:
    """Return a node's full name, "" while the domain has not told it."""
    return "" if base in ("", _UNKNOWN) else f"{space.rstrip('/')}/{base}"


def gid_of(info: TopicEndpointInfo) -> bytes:
    """Return an endpoint's GID, without what pads it in older distributions."""
    return bytes(info.endpoint_gid)[:GID_SIZE]


def _type_hash(info: TopicEndpointInfo) -> str:
    """Return the type's hash; distributions before Iron have none."""
    type_hash = getattr(info, "topic_type_hash", None)
    return "" if type_hash is None or type_hash.version < 1 else str(type_hash)


def qos_of(profile: QoSProfile) -> QoS:
    """Return a profile in our words; what is unknown or the system's choice is ROS 2's default."""
    best_effort = profile.reliability == ReliabilityPolicy.BEST_EFFORT
    latched = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    by_topic = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    return QoS(
        reliability=Reliability.BEST_EFFORT if best_effort else Reliability.RELIABLE,
        durability=Durability.TRANSIENT_LOCAL if latched else Durability.VOLATILE,
        depth=profile.depth,
        deadline=_finite_nanoseconds(profile.deadline),
        lifespan=_finite_nanoseconds(profile.lifespan),
        liveliness=Liveliness.MANUAL_BY_TOPIC if by_topic else Liveliness.AUTOMATIC,
        lease=_finite_nanoseconds(profile.liveliness_lease_duration),
    )


def _finite_nanoseconds(duration: Duration) -> int:
    """Return a duration in ns, 0 for one without end."""
    return int(duration.nanoseconds) if 0 < duration.nanoseconds < _INFINITE else 0


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
