"""A Unix socket between two processes of the guard: messages as pickles, each with its length.

Only processes of the guard's user are spoken to, and these could write its files and its memory.
"""

import logging
import pickle
import socket
import struct
from collections.abc import Callable

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.common.framed_channel import FramedChannel

log = logging.getLogger(__name__)

MAX_MESSAGE_BYTES = 1 << 22
"""The longest message, bytes; a longer one is not sent."""
MAX_PENDING_BYTES = 1 << 23


class MessageChannel(FramedChannel):
    """Sends and receives objects."""

    HEAD = struct.Struct("=I")
    MAX_PENDING = MAX_PENDING_BYTES

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        on_message: Callable[[object], None],
        on_lost: Callable[[], None],
    ) -> None:
        super().__init__(loop, sock, on_lost)
        self._on_message = on_message
        self._log_throttle = LogThrottle()

    def send(self, message: object) -> None:
        """Send a message, now or as soon as there is room; nothing after the end.

        A message that is too long is refused: the other ones matter, and it would come again.
        """
        body = pickle.dumps(message)
        if len(body) <= MAX_MESSAGE_BYTES:
            self._put(body)
        else:
            name = message[0] if isinstance(message, tuple) else type(message).__name__
            self._log_refusal(name, len(body))

    def _log_refusal(self, name: str, size: int) -> None:
        if self._log_throttle.allows(name, self._loop.now()):
            log.error("a %s of %d bytes is too long for the guard's other process", name, size)

    def _longest_body(self, *_head: int) -> int:
        return MAX_MESSAGE_BYTES

    def _receive(self, body: bytes, *_head: int) -> None:
        self._on_message(pickle.loads(body))  # noqa: S301 - a process of our own user
