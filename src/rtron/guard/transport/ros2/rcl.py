"""rcl's C interface for the data path (rcl/subscription.h, publisher.h, graph.h).

rclpy can only ask all subscriptions which of them has messages; rcl calls back. With libc's
`eventfd_write` as its callback the news arrive at a selector without Python in between. Taking and
publishing use rcl too: one buffer for all, and the publisher's GID with each message, which rclpy
gives only since Kilted.
"""

from __future__ import annotations

import ctypes
import logging
import os
from ctypes import addressof, c_int, c_void_p
from typing import TYPE_CHECKING, Any

from rtron.errors import WireError
from rtron.wire.ros2.c_structures import (
    GID_SIZE,
    MessageBuffer,
    MessageInfo,
    SerializedMessage,
    typed_function,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.sender_ids import SenderIds

log = logging.getLogger(__name__)

_OK, _NO_MESSAGE = 0, 401
"""RCL_RET_OK and RCL_RET_SUBSCRIPTION_TAKE_FAILED (rcl/types.h), Foxy and later."""
_UNSUPPORTED = (1 << 64) - 1
"""RMW_MESSAGE_INFO_SEQUENCE_NUMBER_UNSUPPORTED"""
_MAX_COUNT = 64


class Rcl:
    """Calls of rcl, and the one buffer that messages are taken into."""

    def __init__(self, sender_ids: SenderIds) -> None:
        self._gid_of = sender_ids.gid
        rcl = ctypes.CDLL("librcl.so")
        pointers = c_void_p, c_void_p, c_void_p
        self._take = typed_function(rcl.rcl_take_serialized_message, c_int, *pointers, c_void_p)
        self._publish = typed_function(rcl.rcl_publish_serialized_message, c_int, *pointers)
        self._condition = typed_function(rcl.rcl_node_get_graph_guard_condition, c_void_p, c_void_p)
        self._add = typed_function(rcl.rcl_wait_set_add_guard_condition, c_int, *pointers)
        self._reset = typed_function(ctypes.CDLL("librcutils.so").rcutils_reset_error, None)
        self._notify = {
            kind: typed_function(getattr(rcl, name), c_int, *pointers)
            for kind, name in _NOTIFY.items()
        }
        self._eventfd_write = ctypes.cast(ctypes.CDLL(None).eventfd_write, c_void_p)
        self._input_buffer = MessageBuffer()
        self._output = SerializedMessage(allocator=self._input_buffer.allocator)
        self._info = MessageInfo()
        self._in_at, self._out_at = self._input_buffer.address, addressof(self._output)
        self._info_at = addressof(self._info)
        gid_at = MessageInfo.gid.offset
        self._id = memoryview(self._info).cast("B")[gid_at : gid_at + GID_SIZE]

    def notify(self, kind: str, handle: Any, fd: int) -> None:  # noqa: ANN401 - rclpy's handle
        """Let rcl add to the eventfd `fd` whenever a message arrives for a handle.

        `kind` is `subscription`, `service` or `client`. WireError if rcl cannot do it.
        """
        code = self._notify[kind](handle.pointer, self._eventfd_write, fd)
        self._check(code, "register a callback")

    def take(self, subscription: int, begin: int = 0) -> tuple[bytes, bytes] | None:
        """Return the next message of a subscription, by its pointer, and its publisher's GID.

        Of a message only the first `begin` bytes, unless that is 0.
        """
        code = self._take(subscription, self._in_at, self._info_at, None)
        if code == _NO_MESSAGE:
            return None
        if code:
            self._check(code, "take a message")
        return self._input_buffer.message_bytes(begin), self._gid_of(self._id.tobytes())

    @property
    def size(self) -> int:
        """How many bytes the last taken message has."""
        return self._input_buffer.size

    @property
    def source_time(self) -> int:
        """When the last taken message was sent, ns of its publisher's wall clock; 0 if unknown."""
        time: int = self._info.source_timestamp
        return time

    @property
    def sequence_number(self) -> int | None:
        """The sequence number of the last taken message; None where the RMW does not give it."""
        number: int = self._info.publication_sequence_number
        return None if number == _UNSUPPORTED else number

    def publish(self, publisher: int, message: bytes) -> None:
        """Send a serialized message with a publisher, by its pointer."""
        out = self._output
        out.buffer = message
        out.length = out.capacity = len(message)
        if code := self._publish(publisher, self._out_at, None):
            self._check(code, "publish")

    def add_graph_condition(self, wait_set: int, node: int) -> None:
        """Let a wait set, by its pointer, wake up when the graph of a node changes."""
        self._check(self._add(wait_set, self._condition(node), None), "watch the graph")

    def _check(self, code: int, what: str) -> None:
        if code != _OK:
            self._reset()
            raise WireError(f"rcl cannot {what}: error {code}")


_NOTIFY = {
    "subscription": "rcl_subscription_set_on_new_message_callback",
    "service": "rcl_service_set_on_new_request_callback",
    "client": "rcl_client_set_on_new_response_callback",
}
"""rcl's functions that take a callback, `void (const void * user_data, size_t count)`, and its
`user_data`, Humble and later: `eventfd_write(int, uint64_t)` takes the same registers."""


class EventFd:
    """An eventfd that the event loop watches: DDS adds to it, the loop calls back with the count.

    It calls `on_count(count)`, at most 64 at a time, so that a flood does not block the loop.
    It may return how many it left for later, behind other events of the loop.
    """

    def __init__(self, loop: EventLoop, on_count: Callable[[int], int | None]) -> None:
        self._loop = loop
        self._on_count = on_count
        self.fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        loop.watch(self, self._on_readable, self._on_error)

    def fileno(self) -> int:
        """Return the descriptor, for a selector."""
        return self.fd

    def close(self) -> None:
        """Close the descriptor; only the loop calls it."""
        if self.fd >= 0:
            os.close(self.fd)
        self.fd = -1

    def stop(self) -> None:
        """Stop watching, and close."""
        self._loop.forget(self)

    def _on_readable(self) -> None:
        """Pass on the count; after a failure count the rest again, so that no message stays."""
        count = os.eventfd_read(self.fd)
        now = min(count, _MAX_COUNT)
        left = now - 1
        try:
            left = self._on_count(now) or 0
        finally:
            left += count - now
            if left and self.fd >= 0:
                os.eventfd_write(self.fd, left)

    def _on_error(self, error: Exception) -> None:
        log.error("an event of ROS 2 could not be handled: %s", error)
