"""A listening socket of the loop; both TCPROS and the XML-RPC slaves use it."""

import logging
import socket
from collections.abc import Callable

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros1.tuning import set_socket_options

log = logging.getLogger(__name__)

_BACKLOG = 128
_PAUSE_S = 0.1


class TcpServer:
    """Accepts connections and hands each over, non-blocking; port 0 is a free one."""

    def __init__(
        self,
        loop: EventLoop,
        host: str,
        on_connection: Callable[[socket.socket], object],
        port: int = 0,
    ) -> None:
        self._loop = loop
        self._on_connection = on_connection
        self._sock = socket.create_server((host, port), backlog=_BACKLOG)
        self._sock.settimeout(0)
        self.port: int = self._sock.getsockname()[1]
        loop.watch(self._sock, self._accept, self._on_error)

    def close(self) -> None:
        """Listen no more."""
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
