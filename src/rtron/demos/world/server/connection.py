"""A client's connection, on the world's side."""

import socket
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rtron.demos.world.outbox import Outbox
from rtron.demos.world.server.protocol import Frame, Head, Parser, encode

if TYPE_CHECKING:
    from rtron.demos.world.server.requests import Role

_CHUNK = 64 * 1024


class Connection:
    """Never blocks. Clients send no blobs, and are told nothing before they have said hello."""

    def __init__(self, peer: socket.socket, hello_until: float) -> None:
        peer.settimeout(0)
        self.socket = peer
        self.role: Role | None = None
        self.hello_until = hello_until
        """Until when the client must have said hello, wall s."""
        self._parser = Parser(max_blob=0)
        self._outbox = Outbox()

    @property
    def has_more(self) -> bool:
        """Whether something waits to be sent."""
        return bool(self._outbox)

    def received(self) -> Iterator[Frame]:
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

    def must(self, head: Head) -> None:
        """Send a frame that must arrive."""
        self._outbox.must(encode(head))
        self.flush()

    def state(self, frame: bytes) -> None:
        """Send the bytes of a frame that a newer one may replace."""
        self._outbox.state(frame)
        self.flush()

    def flush(self) -> None:
        """Send what the peer can take now; EOFError if it is gone."""
        self._outbox.flush(self._send)

    def close(self) -> None:
        """Close the connection."""
        self.socket.close()

    def _send(self, data: memoryview) -> int:
        try:
            return self.socket.send(data)
        except BlockingIOError:
            return 0
        except ConnectionError as error:
            raise EOFError from error
