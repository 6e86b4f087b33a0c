"""A client's connection, on the world's side."""

import socket
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rtron.demos.world.outbox import SendQueue
from rtron.demos.world.server.protocol import DeviceFrame, FrameParser, Head, encode_frame

if TYPE_CHECKING:
    from rtron.demos.world.server.requests import ClientRole

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
