"""The server: uvicorn as RTron wants it, with a bound on everything a stranger may hold."""

import asyncio
import signal
import socket
import ssl
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from ipaddress import ip_address, ip_network
from typing import Any

import h11
import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.h11_impl import H11Protocol

from rtron.errors import InputError, SourceError
from rtron.service.config import ServiceConfig, Tls
from rtron.service.domain.login_throttle import network_prefix
from rtron.wire.common.link_protocol import MAX_MESSAGE_BYTES

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
            MAX_PER_TRUSTED_ADDRESS if self._is_trusted(address) else MAX_PER_ADDRESS
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

    def _is_trusted(self, address: str) -> bool:
        try:
            parsed = ip_address(address.partition("%")[0])
        except ValueError:
            return True
        parsed = getattr(parsed, "ipv4_mapped", None) or parsed
        return parsed.is_loopback or any(parsed in proxy for proxy in self._proxies)


_MAX_CONNECTIONS = 1000
_HEAD_TIMEOUT_S = 10.0
_BODY_TIMEOUT_S = 25.0
"""Longer than the API waits for a body, so that it can say that it was too slow."""
_KEEP_ALIVE_S = 5
_MAX_HEAD_BYTES = 1 << 15
_SHUTDOWN_TIMEOUT_S = 5


class LimitedHttpProtocol(H11Protocol):
    """HTTP, where a request arrives in time or the connection ends, and no address has too many.

    uvicorn's own would wait for ever, and who opens many connections would hold them all.
    """

    def __init__(self, *arguments: Any, connection_limit: ConnectionLimit, **options: Any) -> None:  # noqa: ANN401 - uvicorn's
        """Make the protocol of one connection as uvicorn does, one of a crowd."""
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


class _NotifyingServer(uvicorn.Server):
    """Says when it listens."""

    def __init__(self, config: uvicorn.Config, on_ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._on_ready = on_ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            await asyncio.to_thread(self._on_ready)


def serve(app: FastAPI, config: ServiceConfig, on_ready: Callable[[], None]) -> None:
    """Serve until told to end (Ctrl-C, SIGTERM); SourceError if the port cannot be had.

    `on_ready` is called once it listens.
    """
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, _ignore_signal)  # uvicorn raises it once more when it has ended
    server = _NotifyingServer(uvicorn.Config(app, **uvicorn_options(config)), on_ready)
    try:
        server.run()
    except SystemExit:
        help = "choose another with --port, or end what listens there"
        raise SourceError(f"cannot listen on {config.host} port {config.port}", help=help) from None


def _ignore_signal(_signal: int, _frame: object) -> None:
    """Do nothing: the server has ended in order."""


def uvicorn_options(config: ServiceConfig) -> dict[str, Any]:
    """Return what uvicorn is told. It logs no requests: their addresses may hold secrets."""
    return {
        "host": config.host,
        "port": config.port,
        "http": partial(LimitedHttpProtocol, connection_limit=ConnectionLimit(config.proxies)),
        "ws": "websockets-sansio",
        "ws_max_size": MAX_MESSAGE_BYTES + 1,
        "ws_per_message_deflate": False,
        "h11_max_incomplete_event_size": _MAX_HEAD_BYTES,
        "limit_concurrency": _MAX_CONNECTIONS,
        "timeout_keep_alive": _KEEP_ALIVE_S,
        "timeout_graceful_shutdown": _SHUTDOWN_TIMEOUT_S,
        "log_level": "warning",
        "server_header": False,
        "log_config": None,
        "proxy_headers": bool(config.proxies),
        "forwarded_allow_ips": list(config.proxies),
        **(_tls_options(config.tls) if config.tls else {}),
    }


def _tls_options(tls: Tls) -> dict[str, Any]:
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(tls.cert, tls.key)
    except (OSError, ssl.SSLError) as error:
        help = "give the certificate with its chain, and its key without password, as PEM"
        raise InputError(f"TLS: {error}", path=str(tls.cert), help=help) from None
    return {"ssl_certfile": str(tls.cert), "ssl_keyfile": str(tls.key)}
