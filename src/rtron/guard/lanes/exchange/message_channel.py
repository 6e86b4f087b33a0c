"""A Unix socket between two processes of the guard: messages as pickles, each with its length.

Only processes of the guard's user are spoken to, and these could write its files and its memory.
"""

import logging
import pickle
import socket
import struct
from collections.abc import Callable

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle

log = logging.getLogger(__name__)

_LENGTH = struct.Struct("=I")
_CHUNK = 1 << 16
MAX_MESSAGE_BYTES = 1 << 22
"""The longest message, bytes; a longer one is not sent."""
MAX_PENDING_BYTES = 1 << 23
"""What may wait for a process that does not read, bytes; beyond, the connection ends."""


class MessageChannel:
    """Sends and receives objects; the loop never waits for the other side.

    `on_lost` is called once, when the connection has ended or the other side reads nothing.
    """

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        on_message: Callable[[object], None],
        on_lost: Callable[[], None],
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._on_message = on_message
        self._on_lost = on_lost
        self._received = bytearray()
        self._pending = bytearray()
        self._is_open = True
        self._log_throttle = LogThrottle()
        sock.settimeout(0)
        loop.watch(sock, self._on_readable, lambda _: self.close())

    @property
    def has_pending(self) -> bool:
        """Whether something waits for the other side to read."""
        return bool(self._pending)

    def send(self, message: object) -> None:
        """Send a message, now or as soon as there is room; nothing after the end.

        A message that is too long is refused: the other ones matter, and it would come again.
        """
        body = pickle.dumps(message)
        if len(body) > MAX_MESSAGE_BYTES:
            name = message[0] if isinstance(message, tuple) else type(message).__name__
            self._log_refusal(name, len(body))
            return
        is_idle = not self._pending
        self._pending += _LENGTH.pack(len(body)) + body
        if len(self._pending) > MAX_PENDING_BYTES:
            self.close()
        elif is_idle and self._is_open:
            self._flush()

    def close(self) -> None:
        """End the connection."""
        if self._is_open:
            self._is_open = False
            self._loop.forget(self._sock)
            self._on_lost()

    def _log_refusal(self, name: str, size: int) -> None:
        if self._log_throttle.allows(name, self._loop.now()):
            log.error("a %s of %d bytes is too long for the guard's other process", name, size)

    def _flush(self) -> None:
        try:
            sent = self._sock.send(memoryview(self._pending)[:_CHUNK])
        except BlockingIOError:
            sent = 0
        except OSError:
            self.close()
            return
        del self._pending[:sent]
        self._loop.await_writable(self._sock, self._flush if self._pending else None)

    def _on_readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        if not data:
            raise WireError("the other process of the guard is gone")
        self._received += data
        while self._is_open and (body := self._take_message()) is not None:
            self._on_message(pickle.loads(body))  # noqa: S301 - a process of our own user

    def _take_message(self) -> bytes | None:
        if len(self._received) < _LENGTH.size:
            return None
        (size,) = _LENGTH.unpack_from(self._received)
        if size > MAX_MESSAGE_BYTES:
            raise WireError(f"the other process of the guard announces {size} bytes")
        end = _LENGTH.size + size
        if len(self._received) < end:
            return None
        body = bytes(self._received[_LENGTH.size : end])
        del self._received[:end]
        return body
