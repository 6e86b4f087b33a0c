"""The HTTP server: uvicorn, with a bound on everything that a client may hold."""

import asyncio
import os
import signal
import socket
import ssl
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import uvicorn
from fastapi import FastAPI

from rtron.errors import InputError, SourceError
from rtron.service.config import ServiceConfig, Tls
from rtron.service.server.http_protocol import ConnectionLimit, LimitedHttpProtocol
from rtron.wire.common.link_protocol import MAX_MESSAGE_BYTES
from rtron.wire.common.systemd import take_notifier

_MAX_CONNECTIONS = 1000
_KEEP_ALIVE_S = 5
_MAX_HEAD_BYTES = 1 << 15
_SHUTDOWN_TIMEOUT_S = 5


class _NotifyingServer(uvicorn.Server):
    """Says when it listens, to `on_ready` and to systemd, which also hears that the loop runs."""

    def __init__(self, config: uvicorn.Config, on_ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._on_ready = on_ready
        self._systemd = take_notifier(os.environ)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            await asyncio.to_thread(self._on_ready)

    async def on_tick(self, counter: int) -> bool:
        self._systemd.report(time.monotonic_ns(), "serving", is_well=True)
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self._systemd.stopping()
        await super().shutdown(sockets)


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
