"""What each participant says of its own nodes: the endpoints that it has.

A participant tells its nodes, with the GIDs of all their readers and writers, on the DDS topic
`ros_discovery_info` (rmw_dds_common/msg/ParticipantEntitiesInfo; ROS 2 design, Node to Participant
mapping). rmw reads it to name endpoints, but does not say which ones it was told of and has not
found. It is no topic of ROS, so that rclpy cannot subscribe it; rmw's C interface can.
"""

from __future__ import annotations

import ctypes
import logging
from ctypes import (
    Structure,
    byref,
    c_bool,
    c_char_p,
    c_int,
    c_uint64,
    c_void_p,
)
from functools import cache
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.serialization import deserialize_message

from rtron.errors import SourceError, WireError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.ros2.cdr_validator import whole
from rtron.wire.ros2.c_structures import Profile, address_in, function
from rtron.wire.ros2.endpoints import GID_SIZE
from rtron.wire.ros2.interfaces import interface
from rtron.wire.ros2.serialized_message import Room

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

log = logging.getLogger(__name__)

_TOPIC = b"ros_discovery_info"
_TYPE = "rmw_dds_common/ParticipantEntitiesInfo"
_MOST_PARTICIPANTS = 4096
_MOST_AT_ONCE = 4096
_KEEP_LAST, _RELIABLE, _TRANSIENT_LOCAL = 1, 1, 1
_DEPTH = 1000
_ASKED = c_void_p, c_void_p, c_char_p, c_void_p, c_void_p


class _Options(Structure):
    """rmw_subscription_options_t, with room for what later versions add."""

    _fields_ = (("words", c_uint64 * 16),)


class Claims:
    """The newest word of every participant; nobody's with an RMW that has no such topic."""

    def __init__(self, node: Node) -> None:
        self._told: dict[bytes, frozenset[bytes]] = {}
        self._taken = c_bool()
        self._room = Room()
        self._rmw = ctypes.CDLL(f"lib{rclpy.get_rmw_implementation_identifier()}.so")
        pointers = c_void_p, c_void_p
        self._take = function(self._rmw.rmw_take_serialized_message, c_int, *pointers, *pointers)
        self._destroy = function(self._rmw.rmw_destroy_subscription, c_int, *pointers)
        handle = function(ctypes.CDLL("librcl.so").rcl_node_get_rmw_handle, c_void_p, c_void_p)
        self._node = handle(node.handle.pointer)
        self._subscription = self._subscribed()

    def gids(self) -> frozenset[bytes]:
        """Return the GIDs of all endpoints that anybody's nodes are said to have now."""
        for _ in range(_MOST_AT_ONCE if self._subscription else 0):
            code = self._take(self._subscription, self._room.at, byref(self._taken), None)
            if code or not self._taken.value:
                break
            self._hear(self._room.taken())
        return frozenset().union(*self._told.values())

    def close(self) -> None:
        """Hear no more; before the node is destroyed."""
        if self._subscription:
            self._destroy(self._node, self._subscription)
            self._subscription = None
        self._room.close()

    def _subscribed(self) -> int | None:
        """Return the subscription's pointer, None if there can be none."""
        try:
            found = interface(_TYPE)
        except SourceError as error:
            log.debug("nobody tells which endpoints its nodes have: %s", error)
            return None
        defaults = function(ctypes.CDLL("librmw.so").rmw_get_default_subscription_options, _Options)
        profile = Profile(
            history=_KEEP_LAST,
            depth=_DEPTH,
            reliability=_RELIABLE,
            durability=_TRANSIENT_LOCAL,
            raw_name=True,
        )
        asked, options = byref(profile), defaults()
        create = function(self._rmw.rmw_create_subscription, c_void_p, *_ASKED)
        made: int | None = create(
            self._node, _type_support(found.cls), _TOPIC, asked, byref(options)
        )
        return made

    def _hear(self, message: bytes) -> None:
        """Take a participant's word in place of its former one; strangers may say anything."""
        try:
            who, gids = read_claim(message)
        except WireError as error:
            log.debug("a participant tells its nodes in no message: %s", error)
            return
        if who in self._told or len(self._told) < _MOST_PARTICIPANTS:
            self._told[who] = gids


def read_claim(message: bytes) -> tuple[bytes, frozenset[bytes]]:
    """Return whose word a message is, and the GIDs in it; WireError if it is none."""
    cls, check = _reading()
    check(message)
    word = deserialize_message(message, cls)
    ends = (
        _gid(end)
        for node in word.node_entities_info_seq
        for end in (*node.reader_gid_seq, *node.writer_gid_seq)
    )
    return _gid(word.gid), frozenset(ends)


@cache
def _reading() -> tuple[Any, Callable[[bytes], object]]:
    """Return the message's class, and what refuses bytes that are none."""
    found = interface(_TYPE)
    return found.cls, whole(parse_definition(found.name, found.definition))


def _type_support(cls: Any) -> int:  # noqa: ANN401 - a generated class
    """Return the pointer that rclpy keeps for a message class."""
    meta = cls.__class__
    if meta._TYPE_SUPPORT is None:  # noqa: SLF001 - so named by rosidl's generator
        meta.__import_type_support__()
    return address_in(meta._TYPE_SUPPORT)  # noqa: SLF001


def _gid(told: Any) -> bytes:  # noqa: ANN401 - a generated class
    return bytes(told.data)[:GID_SIZE]
