"""What each participant says of its own nodes: the endpoints that it has.

A participant tells its nodes, with the GIDs of all their readers and writers, on the DDS topic
`ros_discovery_info` (rmw_dds_common/msg/ParticipantEntitiesInfo; ROS 2 design, Node to Participant
mapping). rmw reads it to name endpoints, but does not say which ones it was told of and has not
found. It is no topic of ROS, so that rclpy cannot subscribe it; rmw's C interface can.
"""

from __future__ import annotations

import ctypes
import logging
from ctypes import byref, c_bool, c_char_p, c_int, c_void_p
from functools import cache
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.serialization import deserialize_message

from rtron.errors import SourceError, WireError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.ros2.cdr_validator import cdr_validator
from rtron.wire.ros2.c_structures import (
    GID_SIZE,
    MessageBuffer,
    QosProfile,
    SubscriptionOptions,
    capsule_pointer,
    typed_function,
)
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.rmw_version import HUMBLE, rmw_version

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

log = logging.getLogger(__name__)

_TOPIC = b"ros_discovery_info"
_TYPE = "rmw_dds_common/ParticipantEntitiesInfo"
_MAX_PARTICIPANTS = 4096
_MAX_MESSAGES_AT_ONCE = 4096
_KEEP_LAST, _RELIABLE, _TRANSIENT_LOCAL = 1, 1, 1
_DEPTH = 1000
_CREATE_ARGUMENTS = c_void_p, c_void_p, c_char_p, c_void_p, c_void_p


class DiscoveryInfoReader:
    """The newest word of every participant; nobody's with an RMW that has no such topic."""

    def __init__(self, node: Node) -> None:
        self._gids_by_participant: dict[bytes, frozenset[bytes]] = {}
        self._is_taken = c_bool()
        self._buffer = MessageBuffer()
        self._rmw = ctypes.CDLL(f"lib{rclpy.get_rmw_implementation_identifier()}.so")
        pointers = c_void_p, c_void_p
        self._take = typed_function(
            self._rmw.rmw_take_serialized_message, c_int, *pointers, *pointers
        )
        self._destroy = typed_function(self._rmw.rmw_destroy_subscription, c_int, *pointers)
        handle = typed_function(
            ctypes.CDLL("librcl.so").rcl_node_get_rmw_handle, c_void_p, c_void_p
        )
        self._node = handle(node.handle.pointer)
        self._subscription = self._create_subscription()

    def gids(self) -> frozenset[bytes]:
        """Return the GIDs of all endpoints that anybody's nodes are said to have now."""
        for _ in range(_MAX_MESSAGES_AT_ONCE if self._subscription else 0):
            code = self._take(self._subscription, self._buffer.address, byref(self._is_taken), None)
            if code or not self._is_taken.value:
                break
            self._store(self._buffer.message_bytes())
        return frozenset().union(*self._gids_by_participant.values())

    def close(self) -> None:
        """Hear no more; before the node is destroyed."""
        if self._subscription:
            self._destroy(self._node, self._subscription)
            self._subscription = None
        self._buffer.close()

    def _create_subscription(self) -> int | None:
        """Return the subscription's pointer, None if there can be none."""
        version = rmw_version()
        if version and version < HUMBLE:  # its options come in registers (`SubscriptionOptions`)
            return None
        try:
            found = find_interface(_TYPE)
        except SourceError as error:
            log.debug("nobody tells which endpoints its nodes have: %s", error)
            return None
        defaults = typed_function(
            ctypes.CDLL("librmw.so").rmw_get_default_subscription_options, SubscriptionOptions
        )
        profile = QosProfile(
            history=_KEEP_LAST,
            depth=_DEPTH,
            reliability=_RELIABLE,
            durability=_TRANSIENT_LOCAL,
            raw_name=True,
        )
        profile_pointer, options = byref(profile), defaults()
        create = typed_function(self._rmw.rmw_create_subscription, c_void_p, *_CREATE_ARGUMENTS)
        subscription: int | None = create(
            self._node, _type_support(found.cls), _TOPIC, profile_pointer, byref(options)
        )
        return subscription

    def _store(self, message: bytes) -> None:
        """Take a participant's word in place of its former one; strangers may say anything."""
        try:
            who, gids = parse_discovery_info(message)
        except WireError as error:
            log.debug("a participant tells its nodes in no message: %s", error)
            return
        if who in self._gids_by_participant or len(self._gids_by_participant) < _MAX_PARTICIPANTS:
            self._gids_by_participant[who] = gids


def parse_discovery_info(message: bytes) -> tuple[bytes, frozenset[bytes]]:
    """Return whose word a message is, and the GIDs in it; WireError if it is none."""
    cls, check = _discovery_info_type()
    check(message)
    info = deserialize_message(message, cls)
    gids = (
        _gid(gid)
        for node in info.node_entities_info_seq
        for gid in (*node.reader_gid_seq, *node.writer_gid_seq)
    )
    return _gid(info.gid), frozenset(gids)


@cache
def _discovery_info_type() -> tuple[Any, Callable[[bytes], object]]:
    """Return the message's class, and what refuses bytes that are none."""
    found = find_interface(_TYPE)
    return found.cls, cdr_validator(parse_definition(found.name, found.definition))


def _type_support(cls: Any) -> int:  # noqa: ANN401 - a generated class
    """Return the pointer that rclpy keeps for a message class."""
    meta = cls.__class__
    if meta._TYPE_SUPPORT is None:  # noqa: SLF001 - so named by rosidl's generator
        meta.__import_type_support__()
    return capsule_pointer(meta._TYPE_SUPPORT)  # noqa: SLF001


def _gid(gid: Any) -> bytes:  # noqa: ANN401 - a generated class
    return bytes(gid.data)[:GID_SIZE]
