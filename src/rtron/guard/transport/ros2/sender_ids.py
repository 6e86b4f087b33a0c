"""Who sent a message or a request: the graph's GID for the id that the RMW gives with it.

The guard decides by GIDs, but an RMW may give another id with a message than it shows in the graph
(rmw/types.h leaves that open). So at the start the guard asks the RMW for the ids of two publishers
of its own, and looks for them in the graph; `abi_check` then compares those of real messages.

- The id is the graph's GID, and begins with the participant's (DDSI-RTPS 2.5, 8.2.4): Fast DDS.
- The id is a handle of this process that Cyclone's library resolves to such a GID: Cyclone DDS.

Every other RMW is refused.
"""

from __future__ import annotations

import ctypes
import uuid
from contextlib import ExitStack
from ctypes import Structure, byref, c_char_p, c_int, c_uint8, c_void_p
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.transport.ros2.cyclone_ids import CycloneSenderIds
from rtron.vocabulary import PRIVATE_ROOT
from rtron.wire.ros2.c_structures import GID_SIZE, RequestId, typed_function
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE, await_publishers
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import rmw_identifier

if TYPE_CHECKING:
    from collections.abc import Collection

    from rclpy.node import Node

_HELP = "use Fast DDS or Cyclone DDS: RMW_IMPLEMENTATION=rmw_fastrtps_cpp for the whole app"


class GraphSenderIds:
    """The ids of an RMW that gives the graph's; see `CycloneSenderIds` for another."""

    request_id_size = ctypes.sizeof(RequestId)

    def gid(self, id: bytes) -> bytes:
        """Return the id."""
        return id

    request_id = rmw_request_id = gid

    def update(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


SenderIds = GraphSenderIds | CycloneSenderIds
"""How the RMW's ids become the graph's.

Our id of a request is its writer's GID and its number (`RequestId`), and behind them what else the
RMW needs to respond; it holds in every process.
"""


def find_sender_ids(node: Node) -> SenderIds:
    """Return how to read the ids of the RMW that a node of ours is in; SourceError if unknown."""
    topic, cls = f"{PRIVATE_ROOT}/self_{uuid.uuid4().hex}", find_interface("std_msgs/Empty").cls
    with ExitStack() as stack:
        publishers = [node.create_publisher(cls, topic, 1) for _ in range(2)]
        for publisher in publishers:
            stack.callback(node.destroy_publisher, publisher)
        gids = {each.gid for each in await_publishers(node, topic, len(publishers))}
        ids = {_message_id(publisher.handle.pointer) for publisher in publishers}
        found = _fitting_ids(node, ids, gids)
    if found is None:
        raise SourceError(
            f"the guard cannot tell senders apart with {rmw_identifier()}", help=_HELP
        )
    return found


def _fitting_ids(node: Node, ids: Collection[bytes], gids: Collection[bytes]) -> SenderIds | None:
    participants = {gid[:PARTICIPANT_SIZE] for gid in gids}
    if len(participants) != 1:
        return None
    if ids == gids:
        return GraphSenderIds()
    cyclone = CycloneSenderIds.open(node.context.get_domain_id(), participants.pop())
    if cyclone and {cyclone.gid(id) for id in ids} == gids:
        return cyclone
    return None


class _Gid(Structure):
    """rmw_gid_t. Before Iron the GID is padded by 8 bytes, and Humble's rmw writes them."""

    _fields_ = (
        ("implementation", c_char_p),
        ("data", c_uint8 * GID_SIZE),
        ("padding", c_uint8 * 8),
    )


def _message_id(publisher: int) -> bytes:
    """Return the id that comes with a publisher's messages (rmw.h, rmw_get_gid_for_publisher)."""
    handle = typed_function(
        ctypes.CDLL("librcl.so").rcl_publisher_get_rmw_handle, c_void_p, c_void_p
    )
    rmw = ctypes.CDLL(f"lib{rmw_identifier()}.so")
    gid, get_gid = _Gid(), typed_function(rmw.rmw_get_gid_for_publisher, c_int, c_void_p, c_void_p)
    if get_gid(handle(publisher), byref(gid)):
        raise SourceError(f"{rmw_identifier()} gives a publisher of the guard no GID", help=_HELP)
    return bytes(gid.data)
