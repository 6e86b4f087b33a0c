"""The connection of a process of the guard and its carrier: messages, and bytes of topics.

A frame has a head and a body: JSON that is checked, or a ROS message as it is. Neither side trusts
the other with its memory, and neither waits for the other.
"""

from __future__ import annotations

import logging
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rtron.errors import WireError
from rtron.guard.cell.ros2.messages import decode, encode

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from pydantic import TypeAdapter

    from rtron.guard.cell.ros2.messages import FromCarrier, ToCarrier
    from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)

_HEAD = struct.Struct("=IIIq")
"""The size of the body, the number of what sends it, its tag, and when it was sent (ns)."""
_CONTROL = 0
"""The number of messages that are JSON."""
_CHUNK = 1 << 16
MAX_MESSAGE_BYTES = 1 << 26
"""The longest message of a topic, bytes; a longer one is lost."""
_MAX_CONTROL_BYTES = 1 << 22
_MAX_PENDING_BYTES = 1 << 26
"""What may wait for the other side, bytes, beside one message; what comes then is lost."""


@dataclass(frozen=True, slots=True)
class TopicData:
    """A message of a topic or a service.

    `id` is the number of its output, connection or service, `tag` that of what latches it, 0 if
    nothing does, or of the call. `sent_at` is the time of the machine's steady clock, ns.
    """

    id: int
    tag: int
    sent_at: int
    message: bytes


class CarrierChannel:
    """Sends and receives; `on_lost` is called once when the connection has ended."""

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        adapter: TypeAdapter[Any],
        on_message: Callable[[Any], None],
        on_data: Callable[[TopicData], None],
        on_lost: Callable[[], None],
    ) -> None:
        """`adapter` reads what the other side may say."""
        self._loop = loop
        self._sock = sock
        self._adapter = adapter
        self._on_message = on_message
        self._on_data = on_data
        self._on_lost = on_lost
        self._received = bytearray()
        self._pending = bytearray()
        self._is_open = True
        self._is_waiting = False
        sock.settimeout(0)
        loop.watch(sock, self._on_readable, self._on_error)

    def send(self, message: ToCarrier | FromCarrier) -> None:
        """Send a message; what is not sent by then waits."""
        self._put(_CONTROL, 0, encode(message))

    def send_data(self, id: int, message: bytes, tag: int = 0) -> bool:
        """Send a message of a topic or a service; False if it is lost."""
        if len(message) > MAX_MESSAGE_BYTES or len(self._pending) > _MAX_PENDING_BYTES:
            return False
        self._put(id, tag, message)
        return True

    def close(self) -> None:
        """End the connection."""
        if self._is_open:
            self._is_open = False
            self._loop.forget(self._sock)
            self._on_lost()

    def _put(self, id: int, tag: int, body: bytes) -> None:
        if not self._is_open:
            return
        is_idle = not self._pending
        self._pending += _HEAD.pack(len(body), id, tag, self._loop.now())
        self._pending += body
        if len(self._pending) > _MAX_PENDING_BYTES + MAX_MESSAGE_BYTES + _MAX_CONTROL_BYTES:
            self.close()
        elif is_idle:
            self._flush()

    def _flush(self) -> None:
        try:
            sent = self._sock.send(memoryview(self._pending)[:_CHUNK])
        except BlockingIOError:
            sent = 0
        except OSError:
            self.close()
            return
        del self._pending[:sent]
        if self._is_waiting != bool(self._pending):
            self._is_waiting = not self._is_waiting
            self._loop.await_writable(self._sock, self._flush if self._is_waiting else None)

    def _on_error(self, error: Exception) -> None:
        log.warning("a carrier's connection ends: %s", error)
        self.close()

    def _on_readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        if not data:
            self.close()
            return
        self._received += data
        while self._is_open and self._take():
            pass

    def _take(self) -> bool:
        """Take a frame if one is complete."""
        if len(self._received) < _HEAD.size:
            return False
        size, id, tag, sent_at = _HEAD.unpack_from(self._received)
        if size > (MAX_MESSAGE_BYTES if id else _MAX_CONTROL_BYTES):
            raise WireError(f"the other side announces {size} bytes")
        end = _HEAD.size + size
        if len(self._received) < end:
            return False
        body = bytes(memoryview(self._received)[_HEAD.size : end])
        del self._received[:end]
        if id:
            self._on_data(TopicData(id, tag, sent_at, body))
        else:
            self._on_message(decode(self._adapter, body))
        return True
