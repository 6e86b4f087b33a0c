"""A service that passes between a cell and the app (ROS wiki: ROS/TCPROS, Services).

Who may call is known by the name in the connection header, which ROS 1 does not protect.
"""

import logging
import socket
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from urllib.parse import urlsplit

from rtron.errors import RTronError, WireError
from rtron.guard.cell.topic_relay import CellRefusals
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.printable import printable
from rtron.guard.transport.ros1.tcp_server import TcpServer, set_socket_options
from rtron.vocabulary import CarriedService, matches_node
from rtron.wire.ros1.network import Network, bind_address
from rtron.wire.ros1.tcpros import (
    LENGTH,
    MAX_HEADER,
    decode_header,
    encode_header,
    frame_length,
)
from rtron.wire.ros1.xmlrpc import ros_call

log = logging.getLogger(__name__)

_TIMEOUT_S = 3.0
_PERIOD_S = 0.5
_HEADER_S = 10.0
_CHUNK = 1 << 16
_MAX_PENDING = 1 << 24
_MAX_CALLS = 64
"""How many connections one service may have at once: each is one to the node, too."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceSide:
    """One side of a cell: its master, its network, and the node that serves or calls there."""

    master: str
    network: Network
    host: str
    node: str
    node_uri: str


class ServiceRelay:
    """Serves on one side what a node serves on the other, for the clients of the manifest."""

    def __init__(
        self,
        loop: EventLoop,
        service: CarriedService,
        sides: tuple[ServiceSide, ServiceSide],
        refusals: CellRefusals,
    ) -> None:
        """`sides` are where the service is offered, and where it is called."""
        self.loop = loop
        self.service = service
        self.offered, self.called = sides
        self._refusals = refusals
        self._workers = ThreadPoolExecutor(4, thread_name_prefix=service.service)
        side = self.offered
        address = bind_address(side.host)
        self._server = TcpServer(loop, address, self._accept, network=side.network)
        self._is_closed = self._is_offered = False
        self._calls = 0
        self._follow()

    def close(self) -> None:
        """Serve no more."""
        self._is_closed = True
        self._server.close()
        self._workers.shutdown(wait=False, cancel_futures=True)

    def refusal(self, fields: dict[str, str]) -> str:
        """Return why a client may not call, empty if it may."""
        client = fields.get("callerid", "")
        if fields.get("service") != self.service.service:
            return "no such service"
        if not any(matches_node(name, client) for name in self.service.clients):
            reason = "the manifest does not name it as a client"
            self._refusals.report(f"{printable(client)} to {self.service.service}", reason)
            return f"refused by rtron cell: {reason}"
        return ""

    def call_upstream(
        self, fields: dict[str, str], done: Callable[[Future[tuple[socket.socket, bytes]]], None]
    ) -> None:
        """Connect to the service itself, in a thread; `done` runs in the loop."""
        work = self._workers.submit(_connect, self.called, self.service.service, fields)
        work.add_done_callback(lambda each: self.loop.post(partial(done, each)))

    def end_call(self) -> None:
        """Count a connection no more."""
        self._calls -= 1

    def _accept(self, sock: socket.socket) -> None:
        if self._calls >= _MAX_CALLS:
            sock.close()
            reason = f"it has {_MAX_CALLS} connections"
            self._refusals.report(f"a call of {self.service.service}", reason)
            return
        self._calls += 1
        _ServiceCall(self, sock)

    def _follow(self) -> None:
        """Offer the service while it is there; a client may wait for it."""
        if not self._is_closed:
            work = self._workers.submit(self._follow_in_thread)
            work.add_done_callback(lambda _: self.loop.post(self._follow_later))

    def _follow_later(self) -> None:
        self.loop.call_later(_PERIOD_S, self._follow)

    def _follow_in_thread(self) -> None:
        side, name = self.offered, self.service.service
        api = f"rosrpc://{side.host}:{self._server.port}"
        if _look_up(self.called, name):
            self._is_offered = True
            _call(side, "registerService", name, api, side.node_uri)
        elif self._is_offered:
            self._is_offered = False
            _call(side, "unregisterService", name, api)


class _ServiceCall:
    """A client's connection, and the one to the service that it leads to."""

    def __init__(self, relay: ServiceRelay, client: socket.socket) -> None:
        self._relay = relay
        self._loop = relay.loop
        self._client = client
        self._service: socket.socket | None = None
        self._pending: dict[socket.socket, bytearray] = {client: bytearray()}
        self._is_closed = self._is_checked = False
        self._early = bytearray()
        self._loop.watch(client, self._on_client, self._close)
        self._loop.call_later(_HEADER_S, self._close_unchecked)

    def _on_client(self) -> None:
        data = self._client.recv(_CHUNK)
        if not data:
            raise WireError("the client has left")
        if self._service:
            self._send(self._service, data)
        elif self._is_checked:
            self._keep_early(data)
        else:
            self._read_header(data)

    def _read_header(self, data: bytes) -> None:
        self._keep_early(data)
        size = len(self._early)
        if size < LENGTH.size or size < (
            end := LENGTH.size + frame_length(self._early, MAX_HEADER)
        ):
            return
        self._is_checked = True
        fields = decode_header(bytes(self._early[LENGTH.size : end]))
        del self._early[:end]
        why = self._relay.refusal(fields)
        if why:
            self._refuse(why)
        else:
            self._relay.call_upstream(fields, self._on_upstream)

    def _keep_early(self, data: bytes) -> None:
        """Keep what a client sends before the service has answered its header."""
        self._early += data
        if len(self._early) > _MAX_PENDING:
            raise WireError("the client sends too much before the service answers")

    def _on_upstream(self, future: Future[tuple[socket.socket, bytes]]) -> None:
        try:
            service, header = future.result()
        except (OSError, RTronError, ValueError) as error:
            if not self._is_closed:
                self._refuse(str(error))
            return
        if self._is_closed:
            service.close()
            return
        self._service = service
        self._pending[service] = bytearray()
        self._loop.watch(service, self._on_service, self._close)
        self._send(self._client, header)
        self._send(service, bytes(self._early))

    def _on_service(self) -> None:
        data = self._service.recv(_CHUNK) if self._service else b""
        if not data:
            raise WireError("the service has closed the connection")
        self._send(self._client, data)

    def _send(self, sock: socket.socket, data: bytes) -> None:
        pending = self._pending[sock]
        pending += data
        if len(pending) > _MAX_PENDING:
            raise WireError("the other side does not read")
        self._flush(sock)

    def _flush(self, sock: socket.socket) -> None:
        pending = self._pending[sock]
        with suppress(BlockingIOError):
            del pending[: sock.send(pending)]
        self._loop.await_writable(sock, (lambda: self._flush(sock)) if pending else None)

    def _refuse(self, why: str) -> None:
        self._send(self._client, encode_header({"error": why}))
        self._close(WireError(why))

    def _close_unchecked(self) -> None:
        if not self._is_checked:
            self._close(WireError("no connection header in time"))

    def _close(self, error: Exception) -> None:
        if self._is_closed:
            return
        log.debug("a call of %s ends: %s", self._relay.service.service, error)
        self._is_closed = True
        self._relay.end_call()
        for sock in self._pending:
            self._loop.forget(sock)


def _call(side: ServiceSide, method: str, *params: str) -> object:
    """Call the master of a side; None if it does not answer, or says no."""
    arguments = (side.node, *params)
    try:
        return ros_call(side.master, method, *arguments, timeout=_TIMEOUT_S, network=side.network)
    except RTronError as error:
        log.debug("%s", error)
        return None


def _look_up(side: ServiceSide, service: str) -> object:
    return _call(side, "lookupService", service)


def _connect(
    side: ServiceSide, service: str, fields: dict[str, str]
) -> tuple[socket.socket, bytes]:
    """Return a connection to a service, and its header as it came."""
    uri = _look_up(side, service)
    where = urlsplit(str(uri))
    if where.scheme != "rosrpc" or not where.hostname or not where.port:
        raise WireError(f"{service} is at no address: {uri!r}")
    sock = side.network.connect((where.hostname, where.port), _TIMEOUT_S)
    try:
        set_socket_options(sock)
        sock.sendall(encode_header({**fields, "callerid": side.node}))
        header = _read_header(sock)
        sock.settimeout(0)
    except BaseException:
        sock.close()
        raise
    return sock, header


def _read_header(sock: socket.socket) -> bytes:
    deadline, data = time.monotonic() + _TIMEOUT_S, b""
    while len(data) < LENGTH.size or len(data) < LENGTH.size + frame_length(data, MAX_HEADER):
        sock.settimeout(max(1e-3, deadline - time.monotonic()))
        missing = LENGTH.size - len(data)
        if missing <= 0:
            missing = LENGTH.size + frame_length(data, MAX_HEADER) - len(data)
        part = sock.recv(missing)
        if not part:
            raise WireError("the service does not answer the header")
        data += part
    return data
