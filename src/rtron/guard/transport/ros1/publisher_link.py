"""A connection to one publisher, made again while the master lists it."""

import logging
import socket
from collections.abc import Callable
from concurrent.futures import Executor, Future

from rtron.errors import RTronError, WireError
from rtron.guard.core.event_loop import Loop
from rtron.guard.transport.common.protocol import Connect, Lost, Peer, Receive
from rtron.guard.transport.ros1.handshake import Wish, connect
from rtron.wire.ros1.tcpros import FrameReader

log = logging.getLogger(__name__)

_CHUNK = 1 << 14
_LARGEST_READ = 1 << 20
_FIRST_RETRY_S = 0.1
_LAST_RETRY_S = 5.0


class PublisherLink:
    """Connects to the publisher at `uri`, hands its messages on, and reconnects with back-off."""

    def __init__(
        self, loop: Loop, workers: Executor, wish: Wish, uri: str, accept: Connect, lost: Lost
    ) -> None:
        self._loop = loop
        self._workers = workers
        self._wish = wish
        self.uri = uri
        self._accept = accept
        self._lost = lost
        self._peer: Peer | None = None
        self._receive: Receive | None = None
        self._sock: socket.socket | None = None
        self._reader = FrameReader()
        self._retry_s = _FIRST_RETRY_S
        self._said = ""
        self.is_closed = False
        self.outlived = False
        self.node = ""
        self.received = self.received_bytes = 0
        self._dial()

    @property
    def connected(self) -> bool:
        """Tell whether messages can come."""
        return self._sock is not None

    def close(self) -> None:
        """End the connection for good."""
        self.is_closed = True
        self._hang_up()

    def _dial(self) -> None:
        if self.is_closed:
            return
        future = self._workers.submit(connect, self._wish, self.uri)
        future.add_done_callback(lambda done: self._loop.post(lambda: self._dialled(done)))

    def _dialled(self, future: "Future[tuple[socket.socket, Peer]]") -> None:
        try:
            sock, peer = future.result()
        except (OSError, RTronError) as error:
            self._try_later(str(error))
            return
        except Exception:
            log.exception("internal error while connecting to %s", self.uri)
            self._try_later("internal error")
            return
        if self.is_closed:
            sock.close()
            return
        self._begin(sock, peer)

    def _begin(self, sock: socket.socket, peer: Peer) -> None:
        receive = self._accept(peer)
        if receive is None:
            sock.close()
            self._try_later(f"{peer.node} at {self.uri} is refused")
            return
        self.node, self._receive, self._sock = peer.node, receive, sock
        self._peer = peer
        self._reader = FrameReader()
        self._retry_s, self._said = _FIRST_RETRY_S, ""
        log.info("%s takes %s from %s", self._wish.node, self._wish.topic, peer.node)
        self._loop.watch(sock, self._readable, self._broken)

    def _readable(self) -> None:
        sock, receive = self._sock, self._receive
        if sock is None or receive is None:
            return
        data = sock.recv(min(_LARGEST_READ, max(_CHUNK, self._reader.missing)))
        if not data:
            raise WireError("closed by the publisher")
        self.received_bytes += len(data)
        for frame in self._reader.feed(data):
            self.received += 1
            receive(frame)

    def _broken(self, error: Exception) -> None:
        self._hang_up()
        self._try_later(f"{self.node} at {self.uri}: {error}")

    def _hang_up(self) -> None:
        sock, self._sock = self._sock, None
        if sock is not None:
            self._loop.forget(sock)
        peer, self._peer = self._peer, None
        if peer is not None:
            self._lost(peer)

    def _try_later(self, why: str) -> None:
        self.is_closed = self.is_closed or self.outlived
        if self.is_closed:
            return
        if why != self._said:
            log.warning("%s from a publisher of %s: %s", self._wish.node, self._wish.topic, why)
            self._said = why
        self._loop.call_later(self._retry_s, self._dial)
        self._retry_s = min(self._retry_s * 2, _LAST_RETRY_S)


def start(
    loop: Loop, workers: Executor, wish: Wish, accept: Connect, lost: Lost
) -> Callable[[str], PublisherLink]:
    """Return what makes a link from a publisher's address."""
    return lambda uri: PublisherLink(loop, workers, wish, uri, accept, lost)
