"""A topic that one of our nodes subscribes: a link to each publisher that the master lists."""

import logging
import socket
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, Future

from rtron.errors import RTronError, WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.protocol import (
    DEFAULT_INPUT,
    ConnectHandler,
    InputOptions,
    MessageHandler,
    Peer,
)
from rtron.guard.transport.ros1.handshake import TopicRequest, connect
from rtron.wire.ros1.tcpros import FrameBeginReader, FrameReader

log = logging.getLogger(__name__)

_CHUNK = 1 << 14
_LARGEST_READ = 1 << 20
_FIRST_RETRY_S = 0.1
_LAST_RETRY_S = 5.0
_LATCHED_S = 2.0
"""Within which a publisher sends what it has latched to a new connection."""

_Connecting = Future[tuple[socket.socket, Peer]]


class PublisherLink:
    """Connects to the publisher at `uri`, receives its messages, reconnects with back-off.

    `may_be_late` tells whether something may have been sent before we listened: the publisher
    registered before us, or this is not the first connection.
    """

    def __init__(
        self,
        loop: EventLoop,
        workers: Executor,
        request: TopicRequest,
        uri: str,
        on_connect: ConnectHandler,
        options: InputOptions = DEFAULT_INPUT,
    ) -> None:
        self._loop = loop
        self._workers = workers
        self._request = request
        self.uri = uri
        self._on_connect = on_connect
        self._peer: Peer | None = None
        self._on_message: MessageHandler = _ignore
        self._sock: socket.socket | None = None
        self._connecting: _Connecting | None = None
        self._options = options
        self._reader = self._create_reader()
        self._retry_s = _FIRST_RETRY_S
        self._last_logged = ""
        self.is_closed = False
        self.is_from_old_master = False
        self.may_be_late = False
        self.node = ""
        self.received = self.received_bytes = 0
        self._connect()

    @property
    def is_connected(self) -> bool:
        """Return whether the connection is open."""
        return self._sock is not None

    def close(self) -> None:
        """End the connection for good, also one that a worker makes right now."""
        self.is_closed = True
        self._disconnect()
        if self._connecting:
            self._connecting.add_done_callback(_close_connection)

    def _connect(self) -> None:
        if self.is_closed:
            return
        self._connecting = self._workers.submit(connect, self._request, self.uri)
        self._connecting.add_done_callback(
            lambda done: self._loop.post(lambda: self._on_connected(done))
        )

    def _on_connected(self, future: _Connecting) -> None:
        if self.is_closed:
            return
        self._connecting = None
        try:
            sock, peer = future.result()
        except (OSError, RTronError) as error:
            self._retry_later(str(error))
            return
        except Exception:
            log.exception("internal error while connecting to %s", self.uri)
            self._retry_later("internal error")
            return
        self._start_receiving(sock, peer)

    def _start_receiving(self, sock: socket.socket, peer: Peer) -> None:
        receive = self._on_connect(peer)
        if receive is None:
            sock.close()
            self._retry_later(f"{peer.node} at {self.uri} is refused")
            return
        self.node, self._peer, self._sock = peer.node, peer, sock
        self._on_message = receive
        if peer.latching and self.may_be_late and self._options.is_command(peer):
            self._skip_latched(peer, receive)
        self._reader = self._create_reader()
        self._retry_s, self._last_logged = _FIRST_RETRY_S, ""
        log.info("%s takes %s from %s", self._request.node, self._request.topic, peer.node)
        self._loop.watch(sock, self._on_readable, self._on_error)

    def _skip_latched(self, peer: Peer, receive: MessageHandler) -> None:
        """Drop the first message if it comes with the connection: it was sent before."""

        def drop(_message: bytes) -> None:
            self._on_message = receive
            text = "%s: a command that %s sent before the guard listened is dropped"
            log.warning(text, self._request.topic, peer.node)
            self._options.on_missed(peer, 1)

        def end() -> None:
            if self._on_message is drop:
                self._on_message = receive

        self._on_message = drop
        self._loop.call_later(_LATCHED_S, end)

    def _on_readable(self) -> None:
        sock, reader = self._sock, self._reader
        if sock is None:
            return
        for frame in self._skip(sock) if reader.skippable else reader.feed(self._read(sock)):
            self.received += 1
            self._on_message(frame)

    def _skip(self, sock: socket.socket) -> list[bytes]:
        """Let the kernel drop what nobody needs, without a copy (tcp(7))."""
        return self._reader.skip(len(self._read(sock, self._reader.skippable, socket.MSG_TRUNC)))

    def _read(self, sock: socket.socket, size: int = _CHUNK, flags: int = 0) -> bytes:
        data = sock.recv(min(_LARGEST_READ, max(size, self._reader.missing)), flags)
        if not data:
            raise WireError("closed by the publisher")
        self.received_bytes += len(data)
        return data

    def _create_reader(self) -> FrameReader | FrameBeginReader:
        begin = self._options.begin
        return FrameBeginReader(begin) if begin else FrameReader()

    def _on_error(self, error: Exception) -> None:
        self._disconnect()
        self._retry_later(f"{self.node} at {self.uri}: {error}")

    def _disconnect(self) -> None:
        sock, self._sock = self._sock, None
        if sock is not None:
            self._loop.forget(sock)
        peer, self._peer = self._peer, None
        if peer is not None:
            self._options.on_lost(peer)

    def _retry_later(self, why: str) -> None:
        self.may_be_late = True
        self.is_closed = self.is_closed or self.is_from_old_master
        if self.is_closed:
            return
        if why != self._last_logged:
            log.warning(
                "%s from a publisher of %s: %s", self._request.node, self._request.topic, why
            )
            self._last_logged = why
        self._loop.call_later(self._retry_s, self._connect)
        self._retry_s = min(self._retry_s * 2, _LAST_RETRY_S)


def _ignore(_message: bytes) -> None:
    """Do nothing with a message."""


def _close_connection(done: _Connecting) -> None:
    if not done.cancelled() and not done.exception():
        done.result()[0].close()


def link_factory(
    loop: EventLoop,
    workers: Executor,
    request: TopicRequest,
    on_connect: ConnectHandler,
    options: InputOptions = DEFAULT_INPUT,
) -> Callable[[str], PublisherLink]:
    """Return a function that creates a link to a publisher's address; see `PublisherLink`."""
    return lambda uri: PublisherLink(loop, workers, request, uri, on_connect, options)


class Subscription:
    """Keeps one link to each publisher; `is_internal` connects two nodes of the guard."""

    def __init__(
        self,
        topic: str,
        type: str,
        create_link: Callable[[str], PublisherLink],
        *,
        is_internal: bool = False,
    ) -> None:
        self.topic = topic
        self.type = type
        self.is_internal = is_internal
        self._create_link = create_link
        self._is_registered = False
        self.links: dict[str, PublisherLink] = {}
        self.own_uris: tuple[str, ...] = ()

    def update(self, uris: Iterable[str], own_uris: frozenset[str]) -> None:
        """Take the master's list of publishers, without our own nodes."""
        self._forget_closed()
        listed_uris = set(uris)
        self.own_uris = tuple(sorted(listed_uris & own_uris))
        expected_uris = set() if self.is_internal else listed_uris - own_uris
        for uri in self.links.keys() - expected_uris:
            if not self.links[uri].is_from_old_master:
                self.links.pop(uri).close()
        for uri in self.links.keys() & expected_uris:
            self.links[uri].is_from_old_master = False
        for uri in expected_uris - self.links.keys():
            self.links[uri] = self._create_link(uri)
            self.links[uri].may_be_late = not self._is_registered
        self._is_registered = True

    def keep_working_links(self) -> None:
        """Keep the links that work although a new master does not list them, as ROS does."""
        for link in self.links.values():
            link.is_from_old_master = link.is_connected

    def _forget_closed(self) -> None:
        self.links = {uri: link for uri, link in self.links.items() if not link.is_closed}

    def close(self) -> None:
        """Close every link."""
        for link in self.links.values():
            link.close()
        self.links.clear()
