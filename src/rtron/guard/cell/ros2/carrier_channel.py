"""The connection of a process of the guard and its carrier: messages, and bytes of topics.

A frame has a head and a body: JSON that is checked, or a ROS message as it is. Neither side trusts
the other with its memory, and neither waits for the other.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rtron.guard.cell.ros2.messages import decode, encode
from rtron.guard.transport.common.framed_channel import FramedChannel

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from pydantic import TypeAdapter

    from rtron.guard.cell.ros2.messages import FromCarrier, ToCarrier
    from rtron.guard.core.event_loop import EventLoop

_CONTROL = 0
"""The number of messages that are JSON."""
MAX_MESSAGE_BYTES = 1 << 26
"""The longest message of a topic, bytes; a longer one is lost."""
_MAX_CONTROL_BYTES = 1 << 22
_MAX_WAITING_BYTES = 1 << 26
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


class CarrierChannel(FramedChannel):
    """Sends and receives messages and the bytes of topics."""

    HEAD = struct.Struct("=IIIq")
    """The size of the body, the number of what sends it, its tag, and when it was sent (ns)."""
    MAX_PENDING = _MAX_WAITING_BYTES + MAX_MESSAGE_BYTES + _MAX_CONTROL_BYTES

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
        super().__init__(loop, sock, on_lost)
        self._adapter = adapter
        self._on_message = on_message
        self._on_data = on_data

    def send(self, message: ToCarrier | FromCarrier) -> None:
        """Send a message; what is not sent by then waits."""
        self._put(encode(message), _CONTROL, 0, self._loop.now())

    def send_data(self, id: int, message: bytes, tag: int = 0) -> bool:
        """Send a message of a topic or a service; False if it is lost."""
        if len(message) > MAX_MESSAGE_BYTES or len(self._pending) > _MAX_WAITING_BYTES:
            return False
        self._put(message, id, tag, self._loop.now())
        return True

    def _longest_body(self, *head: int) -> int:
        return _MAX_CONTROL_BYTES if head[0] == _CONTROL else MAX_MESSAGE_BYTES

    def _receive(self, body: bytes, *head: int) -> None:
        id, tag, sent_at = head
        if id == _CONTROL:
            self._on_message(decode(self._adapter, body))
        else:
            self._on_data(TopicData(id, tag, sent_at, body))
