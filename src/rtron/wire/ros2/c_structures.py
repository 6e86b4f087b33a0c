"""C structures of rcutils and rmw that several of our calls share, and C functions with types."""

from __future__ import annotations

import ctypes
from ctypes import (
    Structure,
    addressof,
    c_bool,
    c_char_p,
    c_int,
    c_size_t,
    c_ssize_t,
    c_uint64,
    c_void_p,
    py_object,
)
from typing import Any


class Allocator(Structure):
    """rcutils_allocator_t: five pointers."""

    _fields_ = (("calls", c_void_p * 5),)


class RmwTime(Structure):
    """rmw_time_t."""

    _fields_ = (("sec", c_uint64), ("nsec", c_uint64))


class QosProfile(Structure):
    """rmw_qos_profile_t; `raw_name` is avoid_ros_namespace_conventions."""

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
    """rcutils_uint8_array_t."""

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
        self._buffer = c_void_p.from_address(self.address)
        self._copy_bytes = _bytes_copier()
        self._grow()

    def close(self) -> None:
        """Give the memory back."""
        self._fini(self.address)

    def message_bytes(self) -> bytes:
        """Return the message that was put here last."""
        message: bytes = self._copy_bytes(self._buffer.value, self._message.length)
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
