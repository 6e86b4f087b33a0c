"""A listening socket of the event loop, for TCPROS and for the XML-RPC slaves."""

import logging
import socket
from collections.abc import Callable

from rtron.guard.core.event_loop import EventLoop
from rtron.wire.ros1.network import HOST_NETWORK, Network

_OPTIONS = (
    (socket.IPPROTO_TCP, socket.TCP_NODELAY, 1),
    (socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1),
    (socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 10),
    (socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 5),
    (socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 3),
)


def set_socket_options(sock: socket.socket) -> None:
    """Set the options of a connected socket; keep-alive gives up after 25 s of silence."""
    for level, name, value in _OPTIONS:
        sock.setsockopt(level, name, value)


log = logging.getLogger(__name__)

_BACKLOG = 128
_PAUSE_S = 0.1


class TcpServer:
    """Accepts connections and passes on each as non-blocking; port 0 is a free one."""

    def __init__(
        self,
        loop: EventLoop,
        host: str,
        on_connection: Callable[[socket.socket], object],
        port: int = 0,
        network: Network = HOST_NETWORK,
    ) -> None:
        self._loop = loop
        self._on_connection = on_connection
        self._sock = network.listen(host, port, _BACKLOG)
        self._sock.settimeout(0)
        self.port: int = self._sock.getsockname()[1]
        loop.watch(self._sock, self._accept, self._on_error)

    def close(self) -> None:
        """Stop listening."""
        self._loop.forget(self._sock)

    def _accept(self) -> None:
        try:
            connection, _ = self._sock.accept()
        except OSError as error:
            log.warning("a connection could not be accepted: %s", error)
            self._loop.suspend(self._sock, _PAUSE_S)
            return
        connection.settimeout(0)
        set_socket_options(connection)
        self._on_connection(connection)

    def _on_error(self, error: Exception) -> None:
        log.warning("a connection was dropped while it was set up: %s", error)
