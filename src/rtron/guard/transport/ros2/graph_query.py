"""The endpoints on a topic, through rcl's C interface (rcl/graph.h, rmw/topic_endpoint_info.h).

rclpy creates objects for all endpoints, which takes a second for some 10 000; this module only for
those that the guard needs. A name that is no valid text gets replacement characters.
"""

from __future__ import annotations

import ctypes
from contextlib import contextmanager
from ctypes import addressof, c_bool, c_char_p, c_int, c_void_p, string_at
from typing import TYPE_CHECKING

from rtron.errors import WireError
from rtron.guard.transport.ros2.participants import select_endpoints
from rtron.vocabulary import (
    SECOND,
    Direction,
    Durability,
    Liveliness,
    QoS,
    Reliability,
)
from rtron.wire.ros2.c_structures import (
    GID_SIZE,
    EndpointInfoArray,
    QosProfile,
    RmwTime,
    TypeHash,
    default_allocator,
    endpoint_info,
    typed_function,
)
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, Ros2Endpoint, node_name
from rtron.wire.ros2.rmw_version import rmw_version

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from rclpy.node import Node

    from rtron.wire.ros2.c_structures import EndpointInfo, HumbleEndpointInfo

_BEST_EFFORT, _TRANSIENT_LOCAL, _MANUAL_BY_TOPIC = 2, 1, 3
_NEVER = 1 << 62
_QUERY_SIGNATURE = c_int, c_void_p, c_void_p, c_char_p, c_bool, c_void_p


class GraphQuery:
    """Queries the graph of one of our nodes; `raw` takes the middleware's own topic names.

    Call `check_endpoint_info` before: it checks the layout of the structures.
    """

    def __init__(self, node: Node, *, raw: bool = False) -> None:
        rcl, rmw = ctypes.CDLL("librcl.so"), ctypes.CDLL("librmw.so")
        self._allocator = default_allocator()
        self._node = node
        self._raw = raw
        self._layout = endpoint_info(rmw_version())
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

    def endpoints(
        self,
        topic: str,
        direction: Direction,
        known: Sequence[Ros2Endpoint],
        excluded: Collection[bytes] = (),
    ) -> tuple[Ros2Endpoint, ...]:
        """Return the publishers or subscribers of a topic, at most 256, sorted by their GIDs.

        `known` are those of the query before, `excluded` are participants to leave out.
        WireError if the query fails.
        """
        with self._infos(topic, direction) as infos:
            index_by_gid = {
                gid: at
                for at, gid in enumerate(self._gids(infos))
                if gid[:PARTICIPANT_SIZE] not in excluded
            }
            chosen = select_endpoints(index_by_gid, {each.gid for each in known})
            entries = (self._layout * infos.size).from_address(infos.infos) if chosen else ()
            return tuple(
                _endpoint(topic, direction, gid, entries[index_by_gid[gid]]) for gid in chosen
            )

    def gids(self, topic: str, direction: Direction) -> list[bytes]:
        """Return the GIDs of all publishers or subscribers of a topic; WireError if it fails."""
        with self._infos(topic, direction) as infos:
            return self._gids(infos)

    @contextmanager
    def _infos(self, topic: str, direction: Direction) -> Iterator[EndpointInfoArray]:
        infos, allocator = EndpointInfoArray(), addressof(self._allocator)
        query, node = self._query_functions[direction], self._node.handle.pointer
        if code := query(node, allocator, topic.encode(), self._raw, addressof(infos)):
            raise WireError(f"rcl cannot list the endpoints of {topic}: error {code}")
        try:
            yield infos
        finally:
            self._free(addressof(infos), allocator)

    def _gids(self, infos: EndpointInfoArray) -> list[bytes]:
        """Return the GIDs of all endpoints, without reading the rest."""
        size, first = ctypes.sizeof(self._layout), self._layout.gid.offset
        data = string_at(infos.infos, infos.size * size) if infos.size else b""
        return [data[at : at + GID_SIZE] for at in range(first, len(data), size)]


def _endpoint(
    topic: str, direction: Direction, gid: bytes, info: EndpointInfo | HumbleEndpointInfo
) -> Ros2Endpoint:
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


def _hash(type_hash: TypeHash) -> str:
    """Return a type's hash (REP 2016), "" where there is none."""
    return f"RIHS{type_hash.version:02}_{bytes(type_hash.value).hex()}" if type_hash.version else ""


def _qos(profile: QosProfile) -> QoS:
    """Return a profile as QoS; an unknown or system-default policy is ROS 2's default."""
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
    """Return a duration in ns, 0 for an infinite one."""
    nanoseconds: int = duration.sec * SECOND + duration.nsec
    return nanoseconds if nanoseconds < _NEVER else 0
