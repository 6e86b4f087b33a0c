"""The server: uvicorn as RTron wants it, with a bound on everything a stranger may hold."""

import asyncio
import signal
import ssl
from typing import Any

import h11
import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.h11_impl import H11Protocol

from rtron.errors import InputError, SourceError
from rtron.service.config import Config, Tls
from rtron.wire.link import LONGEST

_MOST_CONNECTIONS = 1000
_PATIENCE_S = 10.0
_LONGEST_HEAD = 1 << 15
_LINGER_S = 5


class PatientProtocol(H11Protocol):
    """HTTP, where the head of a request arrives in time or the connection ends.

    uvicorn's own would wait for ever, and who opens many connections would hold them all.
    """

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request."""
        super().connection_made(transport)
        self._wait_for_head()

    def data_received(self, data: bytes) -> None:
        """Go on waiting if the head is not there yet."""
        super().data_received(data)
        self._wait_for_head()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._stop_waiting()
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Leave the connection to the WebSocket, which has limits of its own."""
        self._stop_waiting()
        super().handle_websocket_upgrade(event)

    def _wait_for_head(self) -> None:
        if self.conn.their_state is not h11.IDLE or self.transport.get_protocol() is not self:
            self._stop_waiting()
        elif self._deadline is None:
            self._deadline = self.loop.call_later(_PATIENCE_S, self.transport.close)

    def _stop_waiting(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


def serve(app: FastAPI, config: Config) -> None:
    """Serve until told to end (Ctrl-C, SIGTERM); SourceError if the port cannot be had."""
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, _end)  # uvicorn raises it once more when it has ended
    server = uvicorn.Server(uvicorn.Config(app, **settings(config)))
    try:
        server.run()
    except SystemExit:
        help = "choose another with --port, or end what listens there"
        raise SourceError(f"cannot listen on {config.host} port {config.port}", help=help) from None


def _end(_signal: int, _frame: object) -> None:
    """Do nothing: the server has ended in order."""


def settings(config: Config) -> dict[str, Any]:
    """Return what uvicorn is told. It logs no requests: their addresses may hold secrets."""
    return {
        "host": config.host,
        "port": config.port,
        "http": PatientProtocol,
        "ws": "websockets-sansio",
        "ws_max_size": LONGEST + 1,
        "ws_per_message_deflate": False,
        "h11_max_incomplete_event_size": _LONGEST_HEAD,
        "limit_concurrency": _MOST_CONNECTIONS,
        "timeout_graceful_shutdown": _LINGER_S,
        "log_level": "warning",
        "server_header": False,
        "log_config": None,
        "proxy_headers": bool(config.proxies),
        "forwarded_allow_ips": list(config.proxies),
        **(_tls(config.tls) if config.tls else {}),
    }


def _tls(tls: Tls) -> dict[str, Any]:
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(tls.cert, tls.key)
    except (OSError, ssl.SSLError) as error:
        help = "give the certificate with its chain, and its key without password, as PEM"
        raise InputError(f"TLS: {error}", path=str(tls.cert), help=help) from None
    return {"ssl_certfile": str(tls.cert), "ssl_keyfile": str(tls.key)}
