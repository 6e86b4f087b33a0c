"""How many connections there may be, of an address and of all, and which has to go.

asyncio makes the protocol of such a connection only after the handshake, for which it waits a
minute: until then nobody would count them, and one silent client could use up all open files.
"""

import asyncio
import socket
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from ipaddress import ip_network
from typing import Any

from rtron.service.domain.client_address import is_trusted, is_within, network_prefix

MAX_PER_ADDRESS = 100
"""The most connections of one address that have not become WebSockets."""


MAX_PER_TRUSTED_ADDRESS = 500
"""Those of this machine, and of a reverse proxy."""


MAX_CONNECTIONS = 2000
"""The most connections of all addresses that have not become WebSockets."""


class ConnectionLimit:
    """Counts connections by address, of IPv6 by the /64; used in the event loop.

    Where there are too many of all addresses, the one that has waited longest for its client has to
    go: for a request, for more of it, or until an answer is read. So those that are silent or slow
    keep nobody out. Guards are no part of it: they have become WebSockets.
    """

    def __init__(self, proxies: Sequence[str], max_connections: int = MAX_CONNECTIONS) -> None:
        self._proxies = tuple(ip_network(proxy, strict=False) for proxy in proxies)
        self._counts: Counter[str] = Counter()
        self._max_connections = max_connections
        self._waiting: dict[object, Callable[[], None]] = {}

    def is_proxy(self, address: str) -> bool:
        """Tell whether an address is one of the reverse proxies; this machine is one if named."""
        return is_within(address, self._proxies)

    def acquire(self, address: str) -> bool:
        """Count a connection, unless there are too many already."""
        key = network_prefix(address)
        if self._counts[key] >= (
            MAX_PER_TRUSTED_ADDRESS if is_trusted(address, self._proxies) else MAX_PER_ADDRESS
        ):
            return False
        if self._counts.total() >= self._max_connections and not self._abort_waiting():
            return False
        self._counts[key] += 1
        return True

    def add_waiting(self, connection: object, abort: Callable[[], None]) -> None:
        """Note that a connection waits for its client; `abort` ends it and releases its address."""
        self._waiting[connection] = abort

    def remove_waiting(self, connection: object) -> None:
        """Note that a connection waits no more, or is over."""
        self._waiting.pop(connection, None)

    def _abort_waiting(self) -> bool:
        """End the connection that has waited longest; tell whether there was one."""
        connection = next(iter(self._waiting), None)
        if connection is not None:
            self._waiting.pop(connection)()
        return connection is not None

    def release(self, address: str) -> None:
        """Count a connection no more."""
        key = network_prefix(address)
        self._counts[key] -= 1
        if not self._counts[key]:
            del self._counts[key]


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
