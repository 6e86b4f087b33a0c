"""C structures of rcutils and rmw, and C functions with types.

No call of theirs tells how a structure is laid out, so each says for which releases it holds: by
the headers of Foxy (rmw 1.0) to Lyrical (rmw 7.10), on x86-64 and AArch64. The guard checks those
that it reads when it starts (`rtron.guard.transport.ros2.abi_check`).
"""

from __future__ import annotations

import ctypes
from ctypes import (
    Structure,
    addressof,
    c_bool,
    c_char_p,
    c_int,
    c_int64,
    c_size_t,
    c_ssize_t,
    c_uint8,
    c_uint64,
    c_void_p,
    py_object,
)
from typing import Any

from rtron.wire.ros2.rmw_version import IRON, Version

GID_SIZE = 16
"""RMW_GID_STORAGE_SIZE: 16 from Iron on; 24 before, of which 8 are padding."""
_RESERVE = 192
"""Bytes behind a structure that rmw fills, for what a later release appends."""


class Allocator(Structure):
    """rcutils_allocator_t: five pointers. Foxy and later."""

    _fields_ = (("calls", c_void_p * 5),)


class RmwTime(Structure):
    """rmw_time_t. Foxy and later."""

    _fields_ = (("sec", c_uint64), ("nsec", c_uint64))


class QosProfile(Structure):
    """rmw_qos_profile_t; `raw_name` is avoid_ros_namespace_conventions. Foxy and later."""

    _fields_ = (
        ("history", c_int),
        ("depth", c_size_t),
        ("reliability", c_int),
        ("durability", c_int),
        ("deadline", RmwTime),
        ("lifespan", RmwTime),
        ("liveliness", c_int),
        ("lease", RmwTime),
        ("raw_name", c_bool),
    )


class TypeHash(Structure):
    """rosidl_type_hash_t. Iron and later."""

    _fields_ = (("version", c_uint8), ("value", c_uint8 * 32))


class EndpointInfo(Structure):
    """rmw_topic_endpoint_info_t. Iron (rmw 7.1) to Lyrical (7.10).

    ros2/rmw#419 appends a field: arrays have another stride.
    """

    _fields_ = (
        ("node", c_char_p),
        ("space", c_char_p),
        ("type", c_char_p),
        ("hash", TypeHash),
        ("kind", c_int),
        ("gid", c_uint8 * GID_SIZE),
        ("qos", QosProfile),
    )


class HumbleEndpointInfo(Structure):
    """rmw_topic_endpoint_info_t. Foxy (rmw 1.0) to Humble (6.1)."""

    hash = TypeHash()
    """There is none, which its version 0 says."""
    _fields_ = (
        ("node", c_char_p),
        ("space", c_char_p),
        ("type", c_char_p),
        ("kind", c_int),
        ("gid", c_uint8 * GID_SIZE),
        ("gid_padding", c_uint8 * 8),
        ("qos", QosProfile),
    )


class EndpointInfoArray(Structure):
    """rmw_topic_endpoint_info_array_t; `infos` has the address of the first. Foxy and later."""

    _fields_ = (("size", c_size_t), ("infos", c_void_p))


def endpoint_info(version: Version | None) -> type[EndpointInfo | HumbleEndpointInfo]:
    """Return the layout of an endpoint in a version of rmw, of an unknown one the newest."""
    return HumbleEndpointInfo if version and version < IRON else EndpointInfo


class MessageInfo(Structure):
    """rmw_message_info_t, times in ns. Humble (rmw 6.1) and later.

    Before, there were no sequence numbers; Humble's GID has 8 bytes of padding more.
    """

    _fields_ = (
        ("source_timestamp", c_int64),
        ("received_timestamp", c_int64),
        ("publication_sequence_number", c_uint64),
        ("reception_sequence_number", c_uint64),
        ("implementation", c_char_p),
        ("gid", c_uint8 * GID_SIZE),
        ("reserve", c_uint8 * _RESERVE),
    )


class RequestId(Structure):
    """rmw_request_id_t. Foxy and later: the GUID always had 16 bytes."""

    _fields_ = (("guid", c_uint8 * GID_SIZE), ("number", c_int64))


class ServiceInfo(Structure):
    """rmw_service_info_t, times in ns. Foxy and later."""

    _fields_ = (
        ("source_timestamp", c_int64),
        ("received_timestamp", c_int64),
        ("request_id", RequestId),
    )


class SubscriptionOptions(Structure):
    """rmw_subscription_options_t, with room for what later releases append. Humble and later.

    Before rmw 6.1 it had 16 bytes, which a function returns in registers, not in memory.
    """

    _fields_ = (("words", c_uint64 * 16),)


def typed_function(function: Any, result: Any, *arguments: Any) -> Any:  # noqa: ANN401 - ctypes
    """Return a C function that knows its types."""
    function.restype, function.argtypes = result, arguments
    return function


def capsule_pointer(capsule: object) -> int:
    """Return the pointer in a capsule of Python, as rosidl's generated classes keep theirs."""
    name = typed_function(ctypes.pythonapi.PyCapsule_GetName, c_char_p, py_object)
    pointer = typed_function(ctypes.pythonapi.PyCapsule_GetPointer, c_void_p, py_object, c_char_p)
    found: int = pointer(capsule, name(capsule))
    return found


def default_allocator() -> Allocator:
    """Return what rcl and rmw get their memory from."""
    utils = ctypes.CDLL("librcutils.so")
    found: Allocator = typed_function(utils.rcutils_get_default_allocator, Allocator)()
    return found


_FIRST_CAPACITY = 1 << 16
_MAX_REUSED_CAPACITY = 1 << 24


class SerializedMessage(Structure):
    """rcutils_uint8_array_t. Foxy and later."""

    _fields_ = (
        ("buffer", c_char_p),
        ("length", c_size_t),
        ("capacity", c_size_t),
        ("allocator", Allocator),
    )


class MessageBuffer:
    """A buffer, of rcutils' own memory, that messages are taken into again and again."""

    def __init__(self) -> None:
        utils = ctypes.CDLL("librcutils.so")
        self._init = typed_function(
            utils.rcutils_uint8_array_init, c_int, c_void_p, c_size_t, c_void_p
        )
        self._fini = typed_function(utils.rcutils_uint8_array_fini, c_int, c_void_p)
        self.allocator = default_allocator()
        self._message = SerializedMessage()
        self.address = addressof(self._message)
        """Where rcl and rmw are to put a message."""
        self.size = 0
        """How many bytes the message has of which `message_bytes` has returned any."""
        self._buffer = c_void_p.from_address(self.address)
        self._copy_bytes = _bytes_copier()
        self._grow()

    def close(self) -> None:
        """Give the memory back."""
        self._fini(self.address)

    def message_bytes(self, begin: int = 0) -> bytes:
        """Return the message that was put here last, or only its first `begin` bytes."""
        self.size = length = self._message.length
        size = min(begin, length) if begin else length
        message: bytes = self._copy_bytes(self._buffer.value, size)
        if self._message.capacity > _MAX_REUSED_CAPACITY:
            self._fini(self.address)
            self._grow()
        return message

    def _grow(self) -> None:
        self._init(self.address, _FIRST_CAPACITY, addressof(self.allocator))


def _bytes_copier() -> Any:  # noqa: ANN401 - ctypes
    """Return what copies bytes from an address; ctypes' own `string_at` is two calls more."""
    copy = ctypes.PyDLL(None).PyBytes_FromStringAndSize
    return typed_function(copy, py_object, c_void_p, c_ssize_t)
