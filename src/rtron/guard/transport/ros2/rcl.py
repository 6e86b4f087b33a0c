"""What the data path needs of rcl's C interface (rcl/subscription.h, publisher.h, graph.h).

rclpy has no call that says which subscription has news without asking all of them; rcl has, and
with libc's `eventfd_write` as its callback the news arrive at a selector without Python in between.
Taking and publishing go the same way: one buffer for all, and the publisher's GID with each
message, which rclpy tells only since Kilted.
"""

from __future__ import annotations

import ctypes
from ctypes import (
    Structure,
    addressof,
    c_char_p,
    c_int,
    c_size_t,
    c_uint8,
    c_void_p,
    string_at,
)
from typing import Any

from rtron.errors import WireError
from rtron.wire.ros2.endpoints import GID_SIZE

_OK, _NOTHING = 0, 401
_FIRST_CAPACITY = 1 << 16
_LARGEST_KEPT = 1 << 24
_INFO_SIZE = 256
_GID_AT = 40
"""Behind two stamps, two sequence numbers and the implementation's name (rmw/types.h)."""


class _Allocator(Structure):
    _fields_ = (("calls", c_void_p * 5),)


class _Serialized(Structure):
    """rcutils_uint8_array_t, which rmw calls a serialized message."""

    _fields_ = (
        ("buffer", c_char_p),
        ("length", c_size_t),
        ("capacity", c_size_t),
        ("allocator", _Allocator),
    )


class Rcl:
    """The calls, and the one buffer that messages are taken into."""

    def __init__(self) -> None:
        rcl, utils = ctypes.CDLL("librcl.so"), ctypes.CDLL("librcutils.so")
        pointers = c_void_p, c_void_p, c_void_p
        self._take = _function(rcl.rcl_take_serialized_message, c_int, *pointers, c_void_p)
        self._publish = _function(rcl.rcl_publish_serialized_message, c_int, *pointers)
        self._condition = _function(rcl.rcl_node_get_graph_guard_condition, c_void_p, c_void_p)
        self._add = _function(rcl.rcl_wait_set_add_guard_condition, c_int, *pointers)
        self._reset = _function(utils.rcutils_reset_error, None)
        self._init = _function(utils.rcutils_uint8_array_init, c_int, c_void_p, c_size_t, c_void_p)
        self._fini = _function(utils.rcutils_uint8_array_fini, c_int, c_void_p)
        self._notify = {
            kind: _function(getattr(rcl, name), c_int, *pointers) for kind, name in _NOTIFY.items()
        }
        self._eventfd_write = ctypes.cast(ctypes.CDLL(None).eventfd_write, c_void_p)
        allocator = _function(utils.rcutils_get_default_allocator, _Allocator)
        self._allocator = allocator()
        self._in, self._out = _Serialized(), _Serialized(allocator=self._allocator)
        self._info = (c_uint8 * _INFO_SIZE)()
        self._in_at, self._out_at = addressof(self._in), addressof(self._out)
        self._info_at = addressof(self._info)
        self._gid_at = self._info_at + _GID_AT
        self._buffer = c_void_p.from_address(self._in_at)
        self._grow()

    def notify(self, kind: str, handle: Any, fd: int) -> None:  # noqa: ANN401 - rclpy's handle
        """Add to the eventfd `fd` whenever something comes in for a handle.

        `kind` is `subscription`, `service` or `client`. WireError if rcl cannot do it.
        """
        self._check(self._notify[kind](handle.pointer, self._eventfd_write, fd), "be told of news")

    def take(self, subscription: int) -> tuple[bytes, bytes] | None:
        """Return the next message of a subscription, by its pointer, and its publisher's GID."""
        code = self._take(subscription, self._in_at, self._info_at, None)
        if code == _NOTHING:
            return None
        if code:
            self._check(code, "take a message")
        message = string_at(self._buffer.value or 0, self._in.length)
        gid = string_at(self._gid_at, GID_SIZE)
        if self._in.capacity > _LARGEST_KEPT:
            self._fini(self._in_at)
            self._grow()
        return message, gid

    def publish(self, publisher: int, message: bytes) -> None:
        """Send a serialized message with a publisher, by its pointer."""
        out = self._out
        out.buffer = message
        out.length = out.capacity = len(message)
        if code := self._publish(publisher, self._out_at, None):
            self._check(code, "publish")

    def watch_graph(self, wait_set: int, node: int) -> None:
        """Let a wait set, by its pointer, wake up when the graph of a node changes."""
        self._check(self._add(wait_set, self._condition(node), None), "watch the graph")

    def _grow(self) -> None:
        self._init(self._in_at, _FIRST_CAPACITY, addressof(self._allocator))

    def _check(self, code: int, what: str) -> None:
        if code != _OK:
            self._reset()
            raise WireError(f"rcl cannot {what}: error {code}")


_NOTIFY = {
    "subscription": "rcl_subscription_set_on_new_message_callback",
    "service": "rcl_service_set_on_new_request_callback",
    "client": "rcl_client_set_on_new_response_callback",
}


def _function(function: Any, result: Any, *arguments: Any) -> Any:  # noqa: ANN401 - ctypes
    function.restype, function.argtypes = result, arguments
    return function
