"""The HTTP protocol of one connection: deadlines for requests, a limit of connections."""

import asyncio
from collections import Counter
from collections.abc import Sequence
from ipaddress import ip_network
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from rtron.service.domain.client_address import is_trusted, network_prefix

MAX_PER_ADDRESS = 100
"""The most connections of one address that have not become WebSockets."""


MAX_PER_TRUSTED_ADDRESS = 500
"""Those of this machine, and of a reverse proxy."""


class ConnectionLimit:
    """Counts connections by address, of IPv6 by the /64; used in the event loop."""

    def __init__(self, proxies: Sequence[str]) -> None:
        self._proxies = tuple(ip_network(proxy, strict=False) for proxy in proxies)
        self._counts: Counter[str] = Counter()

    def acquire(self, address: str) -> bool:
        """Count a connection, unless there are too many already."""
        key = network_prefix(address)
        if self._counts[key] >= (
            MAX_PER_TRUSTED_ADDRESS if is_trusted(address, self._proxies) else MAX_PER_ADDRESS
        ):
            return False
        self._counts[key] += 1
        return True

    def release(self, address: str) -> None:
        """Count a connection no more."""
        key = network_prefix(address)
        self._counts[key] -= 1
        if not self._counts[key]:
            del self._counts[key]


_HEAD_TIMEOUT_S = 10.0


_BODY_TIMEOUT_S = 25.0
"""Longer than the API waits for a body, so that it can say that it was too slow."""


class LimitedHttpProtocol(H11Protocol):
    """HTTP with a deadline for each request and a limit of connections for each address.

    uvicorn's own protocol waits for ever, and one client could hold all connections.
    """

    def __init__(self, *arguments: Any, connection_limit: ConnectionLimit, **options: Any) -> None:  # noqa: ANN401 - uvicorn's
        """Make the protocol of one connection as uvicorn does."""
        super().__init__(*arguments, **options)
        self._connection_limit = connection_limit
        self._counted_address = ""
        self._awaited_state: object = None
        self._deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, if the address has place for one more."""
        super().connection_made(transport)
        address = self.client[0] if self.client else ""
        if not self._connection_limit.acquire(address):
            transport.abort()
            return
        self._counted_address = address
        self._restart_deadline()

    def data_received(self, data: bytes) -> None:
        """Go on waiting for what is not there yet."""
        super().data_received(data)
        self._restart_deadline()

    def on_response_complete(self) -> None:
        """Wait for the rest of the body, or for the next request."""
        super().on_response_complete()
        self._restart_deadline()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._release()
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Leave the connection to the WebSocket, which has limits of its own."""
        self._release()
        super().handle_websocket_upgrade(event)

    def _restart_deadline(self) -> None:
        """Wait for a head, or for a body: each has its time from its beginning on."""
        state = self.conn.their_state
        if state not in (h11.IDLE, h11.SEND_BODY) or self.transport.get_protocol() is not self:
            self._cancel_deadline()
        elif self._awaited_state is not state:
            self._cancel_deadline()
            self._awaited_state = state
            is_idle = state is h11.IDLE
            seconds, end = (
                (_HEAD_TIMEOUT_S, self.transport.close)
                if is_idle
                else (_BODY_TIMEOUT_S, self.transport.abort)
            )
            self._deadline = self.loop.call_later(seconds, end)

    def _release(self) -> None:
        self._cancel_deadline()
        if self._counted_address:
            self._connection_limit.release(self._counted_address)
            self._counted_address = ""

    def _cancel_deadline(self) -> None:
        self._awaited_state = None
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None
