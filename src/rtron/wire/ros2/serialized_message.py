"""rmw's serialized message (rmw/serialized_message.h) for those who call rcl and rmw themselves."""

from __future__ import annotations

import ctypes
from ctypes import Structure, addressof, c_char_p, c_int, c_size_t, c_ssize_t, c_void_p, py_object
from typing import Any

from rtron.wire.ros2.c_structures import Allocator, default_allocator, typed_function

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
