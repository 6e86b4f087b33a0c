"""The server: uvicorn as RTron wants it, with a bound on everything a stranger may hold."""

import asyncio
import signal
import socket
import ssl
from collections.abc import Callable
from functools import partial
from typing import Any

import h11
import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.h11_impl import H11Protocol

from rtron.errors import InputError, SourceError
from rtron.service.config import Config, Tls
from rtron.service.server.connection_limit import Crowd
from rtron.wire.common.link_protocol import LONGEST

_MOST_CONNECTIONS = 1000
_PATIENCE_S = 10.0
_BODY_S = 25.0
"""Longer than the API waits for a body, so that it can say that it was too slow."""
_IDLE_S = 5
_LONGEST_HEAD = 1 << 15
_LINGER_S = 5


class PatientProtocol(H11Protocol):
    """HTTP, where a request arrives in time or the connection ends, and no address has too many.

    uvicorn's own would wait for ever, and who opens many connections would hold them all.
    """

    def __init__(self, *arguments: Any, crowd: Crowd, **options: Any) -> None:  # noqa: ANN401 - uvicorn's
        """Make the protocol of one connection as uvicorn does, one of a crowd."""
        super().__init__(*arguments, **options)
        self._crowd = crowd
        self._counted = ""
        self._waits_for: object = None
        self._deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, if the address has place for one more."""
        super().connection_made(transport)
        address = self.client[0] if self.client else ""
        if not self._crowd.enter(address):
            transport.abort()
            return
        self._counted = address
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Go on waiting for what is not there yet."""
        super().data_received(data)
        self._wait()

    def on_response_complete(self) -> None:
        """Wait for the rest of the body, or for the next request."""
        super().on_response_complete()
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait for nothing more."""
        self._leave()
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Leave the connection to the WebSocket, which has limits of its own."""
        self._leave()
        super().handle_websocket_upgrade(event)

    def _wait(self) -> None:
        """Wait for a head, or for a body: each has its time from its beginning on."""
        state = self.conn.their_state
        if state not in (h11.IDLE, h11.SEND_BODY) or self.transport.get_protocol() is not self:
            self._stop_waiting()
        elif self._waits_for is not state:
            self._stop_waiting()
            self._waits_for = state
            is_idle = state is h11.IDLE
            seconds, end = (
                (_PATIENCE_S, self.transport.close) if is_idle else (_BODY_S, self.transport.abort)
            )
            self._deadline = self.loop.call_later(seconds, end)

    def _leave(self) -> None:
        self._stop_waiting()
        if self._counted:
            self._crowd.leave(self._counted)
            self._counted = ""

    def _stop_waiting(self) -> None:
        self._waits_for = None
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


class _Server(uvicorn.Server):
    """Says when it listens."""

    def __init__(self, config: uvicorn.Config, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._ready = ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            await asyncio.to_thread(self._ready)


def serve(app: FastAPI, config: Config, ready: Callable[[], None]) -> None:
    """Serve until told to end (Ctrl-C, SIGTERM); SourceError if the port cannot be had.

    `ready` is called once it listens.
    """
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, _end)  # uvicorn raises it once more when it has ended
    server = _Server(uvicorn.Config(app, **settings(config)), ready)
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
        "http": partial(PatientProtocol, crowd=Crowd(config.proxies)),
        "ws": "websockets-sansio",
        "ws_max_size": LONGEST + 1,
        "ws_per_message_deflate": False,
        "h11_max_incomplete_event_size": _LONGEST_HEAD,
        "limit_concurrency": _MOST_CONNECTIONS,
        "timeout_keep_alive": _IDLE_S,
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
