"""A bound on connections with TLS whose handshake is not done yet.

asyncio makes the protocol of such a connection only after the handshake, for which it waits a
minute: until then nobody would count them, and one silent client could use up all open files.
"""

import asyncio
import socket
from contextlib import suppress
from typing import Any

from rtron.service.server.connection_limit import ConnectionLimit

HANDSHAKE_TIMEOUT_S = 10.0


class HandshakeSocket(socket.socket):
    """A listening socket that accepts no more handshakes than the limit allows."""

    def __init__(self, listening: socket.socket, limit: ConnectionLimit) -> None:
        """Take the place of a listening socket, which is none afterwards."""
        super().__init__(listening.family, listening.type, listening.proto, listening.detach())
        self._limit = limit

    def accept(self) -> tuple[socket.socket, Any]:
        """Return a connection as socket(7) does; ConnectionAbortedError if it is one too many."""
        accepted, address = super().accept()
        connection = _HandshakingSocket(self.family, self.type, self.proto, accepted.detach())
        if not self._limit.acquire(address[0]):
            connection.close()
            raise ConnectionAbortedError
        connection.begin(self._limit, address[0])
        return connection, address


_handshaking: dict[int, "_HandshakingSocket"] = {}
"""The connections whose handshake is not done, by the numbers of their open files."""


def note_handshake(transport: asyncio.BaseTransport) -> None:
    """Note that the handshake of a connection is done, if it has one."""
    connection = transport.get_extra_info("socket")
    handshaking = _handshaking.get(connection.fileno()) if connection else None
    if handshaking:
        handshaking.finish()


class _HandshakingSocket(socket.socket):
    """A connection that counts until its handshake is done, or it is closed."""

    _limit: ConnectionLimit | None = None

    def begin(self, limit: ConnectionLimit, address: str) -> None:
        """Count, and give the client its time."""
        self._limit, self._address = limit, address
        limit.add_waiting(self, self.abort)
        loop = asyncio.get_running_loop()
        self._deadline = loop.call_later(HANDSHAKE_TIMEOUT_S, self.abort)
        _handshaking[self.fileno()] = self

    def finish(self) -> None:
        """Count no more."""
        if self._limit:
            self._deadline.cancel()
            self._limit.remove_waiting(self)
            self._limit.release(self._address)
            self._limit = None
            del _handshaking[self.fileno()]

    def abort(self) -> None:
        """End the connection: asyncio finds that there is nothing more to read."""
        self.finish()
        with suppress(OSError):
            self.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Close it; it counts no more."""
        self.finish()
        super().close()


def bind_sockets(host: str, port: int) -> list[socket.socket]:
    """Return sockets that listen at all addresses of a host; OSError if they cannot."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    addresses = dict.fromkeys((family, address) for family, *_, address in found)
    return [socket.create_server(address, family=family) for family, address in addresses]
