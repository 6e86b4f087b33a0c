"""Who publishes and subscribes a topic, as the domain tells it: types, QoS and GIDs.

A GID is an endpoint's own; its first 12 bytes are its participant's (OMG DDSI-RTPS 2.5, 8.2.4).
Node names are not unique in ROS 2, GIDs are.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rclpy.qos import DurabilityPolicy, LivelinessPolicy, ReliabilityPolicy

from rtron.vocabulary import Direction, Durability, Liveliness, QoS, Reliability
from rtron.wire.ros2.c_structures import GID_SIZE

if TYPE_CHECKING:
    from collections.abc import Iterable

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
