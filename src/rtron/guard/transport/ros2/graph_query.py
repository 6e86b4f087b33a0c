"""Who is on a topic, through rcl's C interface (rcl/graph.h, rmw/topic_endpoint_info.h).

rclpy makes objects of all there are before it tells of anybody, which takes a second for some
10 000; here only of those who are to be known. A name that is no text is told with replacements.
"""

from __future__ import annotations

import ctypes
import uuid
from ctypes import (
    POINTER,
    Structure,
    addressof,
    c_bool,
    c_char_p,
    c_int,
    c_size_t,
    c_uint8,
    c_void_p,
    string_at,
)
from typing import TYPE_CHECKING

from rtron.errors import SourceError, WireError
from rtron.guard.transport.ros2.participants import select_endpoints
from rtron.vocabulary import (
    PRIVATE_ROOT,
    SECOND,
    Direction,
    Durability,
    Liveliness,
    QoS,
    Reliability,
)
from rtron.wire.ros2.c_structures import QosProfile, RmwTime, default_allocator, typed_function
from rtron.wire.ros2.endpoints import (
    GID_SIZE,
    PARTICIPANT_SIZE,
    Ros2Endpoint,
    node_name,
    publishers_of,
)
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rclpy.node import Node

_BEST_EFFORT, _TRANSIENT_LOCAL, _MANUAL_BY_TOPIC = 2, 1, 3
_NEVER = 1 << 62
_QUERY_SIGNATURE = c_int, c_void_p, c_void_p, c_char_p, c_bool, c_void_p


class _Hash(Structure):
    """rosidl_type_hash_t."""

    _fields_ = (("version", c_uint8), ("value", c_uint8 * 32))


class _EndpointInfo(Structure):
    """rmw_topic_endpoint_info_t."""

    _fields_ = (
        ("node", c_char_p),
        ("space", c_char_p),
        ("type", c_char_p),
        ("hash", _Hash),
        ("kind", c_int),
        ("gid", c_uint8 * GID_SIZE),
        ("qos", QosProfile),
    )


class _EndpointInfoArray(Structure):
    """rmw_topic_endpoint_info_array_t."""

    _fields_ = (("size", c_size_t), ("found", POINTER(_EndpointInfo)))


class GraphQuery:
    """Asks what the domain has told one of our nodes; `raw` asks by the middleware's own names.

    SourceError if this version of ROS 2 lays out its structures in another way than is read here.
    """

    def __init__(self, node: Node, *, raw: bool = False) -> None:
        rcl, rmw = ctypes.CDLL("librcl.so"), ctypes.CDLL("librmw.so")
        self._allocator = default_allocator()
        self._node = node
        self._raw = raw
        self._query_functions = {
            Direction.PUBLISH: typed_function(
                rcl.rcl_get_publishers_info_by_topic, *_QUERY_SIGNATURE
            ),
            Direction.SUBSCRIBE: typed_function(
                rcl.rcl_get_subscriptions_info_by_topic, *_QUERY_SIGNATURE
            ),
        }
        self._free = typed_function(
            rmw.rmw_topic_endpoint_info_array_fini, c_int, c_void_p, c_void_p
        )
        if not raw:
            self._check_layout()

    def endpoints(
        self,
        topic: str,
        direction: Direction,
        known: Sequence[Ros2Endpoint],
        excluded: bytes | None = None,
    ) -> tuple[Ros2Endpoint, ...]:
        """Return who publishes or subscribes a topic, at most 256, by their GIDs.

        `known` are those that were told before, `excluded` is a participant that is left out. WireError
        if rcl cannot tell.
        """
        infos, allocator = _EndpointInfoArray(), addressof(self._allocator)
        query, node = self._query_functions[direction], self._node.handle.pointer
        if code := query(node, allocator, topic.encode(), self._raw, addressof(infos)):
            raise WireError(f"rcl cannot tell who is on {topic}: error {code}")
        try:
            index_by_gid = {
                gid: at for at, gid in enumerate(_gids(infos)) if gid[:PARTICIPANT_SIZE] != excluded
            }
            chosen = select_endpoints(index_by_gid, {each.gid for each in known})
            return tuple(
                _endpoint(topic, direction, gid, infos.found[index_by_gid[gid]]) for gid in chosen
            )
        finally:
            self._free(addressof(infos), allocator)

    def _check_layout(self) -> None:
        """Compare with what rclpy tells of a publisher of ours."""
        topic = f"{PRIVATE_ROOT}/self_{uuid.uuid4().hex}"
        publisher = self._node.create_publisher(find_interface("std_msgs/Empty").cls, topic, 1)
        try:
            read, expected = (
                self.endpoints(topic, Direction.PUBLISH, ()),
                publishers_of(self._node, topic),
            )
        finally:
            self._node.destroy_publisher(publisher)
        if list(read) != expected:
            raise SourceError("the guard does not know this version of ROS 2", help=_HELP)


_HELP = "it knows Jazzy and Kilted; tell us of yours"


def _gids(infos: _EndpointInfoArray) -> list[bytes]:
    """Return the GIDs of all; of a crowd nothing else is looked at."""
    size = ctypes.sizeof(_EndpointInfo)
    data = string_at(infos.found, infos.size * size) if infos.size else b""
    return [data[at : at + GID_SIZE] for at in range(_EndpointInfo.gid.offset, len(data), size)]


def _endpoint(topic: str, direction: Direction, gid: bytes, info: _EndpointInfo) -> Ros2Endpoint:
    return Ros2Endpoint(
        topic=topic,
        direction=direction,
        node=node_name(_text(info.node), _text(info.space)),
        type=_text(info.type),
        type_hash=_hash(info.hash),
        gid=gid,
        qos=_qos(info.qos),
    )


def _text(data: bytes | None) -> str:
    return (data or b"").decode(errors="replace")


def _hash(type_hash: _Hash) -> str:
    """Return a type's hash (REP 2016), "" where there is none."""
    return f"RIHS{type_hash.version:02}_{bytes(type_hash.value).hex()}" if type_hash.version else ""


def _qos(profile: QosProfile) -> QoS:
    """Return a profile in our words; what is unknown or the system's choice is ROS 2's default."""
    best_effort = profile.reliability == _BEST_EFFORT
    latched = profile.durability == _TRANSIENT_LOCAL
    by_topic = profile.liveliness == _MANUAL_BY_TOPIC
    return QoS(
        reliability=Reliability.BEST_EFFORT if best_effort else Reliability.RELIABLE,
        durability=Durability.TRANSIENT_LOCAL if latched else Durability.VOLATILE,
        depth=profile.depth,
        deadline=_bounded(profile.deadline),
        lifespan=_bounded(profile.lifespan),
        liveliness=Liveliness.MANUAL_BY_TOPIC if by_topic else Liveliness.AUTOMATIC,
        lease=_bounded(profile.lease),
    )


def _bounded(duration: RmwTime) -> int:
    """Return a duration in ns, 0 for one without end."""
    nanoseconds: int = duration.sec * SECOND + duration.nsec
    return nanoseconds if nanoseconds < _NEVER else 0
