"""A client's connection, on the world's side."""

import socket
from collections import deque
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from rtron.demos.world.server.protocol import DeviceFrame, FrameParser, Head, encode_frame
from rtron.errors import WireError

if TYPE_CHECKING:
    from rtron.demos.world.server.requests import ClientRole


MAX_WAITING = 64
"""Frames that must arrive."""
MAX_REPLACED_STATES = 400
"""States that were dropped for newer ones while not a byte went out."""


class SendQueue:
    """Frames that must arrive, in order, and the newest state, which replaces an older one."""

    def __init__(self) -> None:
        self._sending = memoryview(b"")
        self._waiting: deque[bytes] = deque()
        self._state: bytes | None = None
        self._dropped = 0

    def __bool__(self) -> bool:
        return bool(self._sending or self._waiting or self._state)

    def add(self, frame: bytes) -> None:
        """Send a frame whatever happens; WireError if the reader is too far behind."""
        if len(self._waiting) >= MAX_WAITING:
            raise WireError("does not read what it asked for")
        self._waiting.append(frame)

    def replace_state(self, frame: bytes) -> None:
        """Send a frame, unless a newer one comes first; WireError if nothing is read any more."""
        self._dropped += self._state is not None
        if self._dropped > MAX_REPLACED_STATES:
            raise WireError("reads nothing")
        self._state = frame

    def flush(self, send: Callable[[memoryview], int]) -> None:
        """Send as much as `send` takes; it returns how many bytes it took."""
        while self:
            if not self._sending:
                self._sending = memoryview(self._next())
            took = send(self._sending)
            self._dropped = 0 if took else self._dropped
            self._sending = self._sending[took:]
            if self._sending:
                return

    def _next(self) -> bytes:
        if self._waiting:
            return self._waiting.popleft()
        frame, self._state = self._state or b"", None
        return frame


_CHUNK = 64 * 1024


class DeviceConnection:
    """Never blocks. Clients send no blobs, and are told nothing before they have said hello."""

    def __init__(self, peer: socket.socket, hello_until: float) -> None:
        peer.settimeout(0)
        self.socket = peer
        self.role: ClientRole | None = None
        self.hello_deadline = hello_until
        """Until when the client must have said hello, wall s."""
        self._parser = FrameParser(max_blob=0)
        self._send_queue = SendQueue()

    @property
    def has_pending_data(self) -> bool:
        """Whether something waits to be sent."""
        return bool(self._send_queue)

    def read_frames(self) -> Iterator[DeviceFrame]:
        """Yield what has come; EOFError at the connection's end, WireError for what is no frame."""
        try:
            data = self.socket.recv(_CHUNK)
        except BlockingIOError:
            return
        except ConnectionError as error:
            raise EOFError from error
        if not data:
            raise EOFError
        yield from self._parser.feed(data)

    def send(self, head: Head) -> None:
        """Send a frame that must arrive."""
        self._send_queue.add(encode_frame(head))
        self.flush()

    def send_state(self, frame: bytes) -> None:
        """Send the bytes of a frame that a newer one may replace."""
        self._send_queue.replace_state(frame)
        self.flush()

    def flush(self) -> None:
        """Send what the peer can take now; EOFError if it is gone."""
        self._send_queue.flush(self._send_bytes)

    def close(self) -> None:
        """Close the connection."""
        self.socket.close()

    def _send_bytes(self, data: memoryview) -> int:
        try:
            return self.socket.send(data)
        except BlockingIOError:
            return 0
        except ConnectionError as error:
            raise EOFError from error
