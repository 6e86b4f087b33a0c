"""The HTTP server: uvicorn, with a bound on everything that a client may hold."""

import asyncio
import gc
import os
import resource
import signal
import socket
import ssl
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import uvicorn
from fastapi import FastAPI

from rtron.errors import InputError, SourceError
from rtron.service.config import ServiceConfig, Tls
from rtron.service.server.connection_limit import ConnectionLimit, HandshakeSocket, bind_sockets
from rtron.service.server.http_protocol import LimitedHttpProtocol, LimitedWebSocketProtocol
from rtron.wire.common.link_protocol import MAX_MESSAGE_BYTES
from rtron.wire.common.systemd import take_notifier

_MAX_FILES = 1 << 16
_COLLECTOR_THRESHOLD = 50_000
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
    _raise_file_limit()
    _relax_garbage_collector()
    server = _NotifyingServer(uvicorn.Config(app, **uvicorn_options(config)), on_ready)
    sockets = _listening_sockets(config) if config.tls else None
    try:
        server.run(sockets)
    except SystemExit:
        raise _cannot_listen(config) from None


def _listening_sockets(config: ServiceConfig) -> list[socket.socket]:
    try:
        bound = bind_sockets(config.host, config.port)
    except OSError:
        raise _cannot_listen(config) from None
    return [HandshakeSocket(each, ConnectionLimit(config.proxies)) for each in bound]


def _cannot_listen(config: ServiceConfig) -> SourceError:
    help = "choose another with --port, or end what listens there"
    return SourceError(f"cannot listen on {config.host} port {config.port}", help=help)


def _raise_file_limit() -> None:
    """Allow as many sockets as the system does: by default a process has 1,024 files open."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    target = _MAX_FILES if hard == resource.RLIM_INFINITY else min(_MAX_FILES, hard)
    if soft != resource.RLIM_INFINITY and soft < target:
        resource.setrlimit(resource.RLIMIT_NOFILE, (target, hard))


def _relax_garbage_collector() -> None:
    """Look for cycles seldom, and not in what is loaded: with 1,000 guards a look stops all 0.4 s.

    States that are replaced each second need no collector, but outlive its young generations.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(_COLLECTOR_THRESHOLD, 20, 20)


def _ignore_signal(_signal: int, _frame: object) -> None:
    """Do nothing: the server has ended in order."""


def uvicorn_options(config: ServiceConfig) -> dict[str, Any]:
    """Return what uvicorn is told. It logs no requests: their addresses may hold secrets."""
    return {
        "host": config.host,
        "port": config.port,
        "http": partial(LimitedHttpProtocol, connection_limit=ConnectionLimit(config.proxies)),
        "ws": partial(LimitedWebSocketProtocol, handshakes=ConnectionLimit(config.proxies)),
        "ws_max_size": MAX_MESSAGE_BYTES + 1,
        "ws_per_message_deflate": False,
        "h11_max_incomplete_event_size": _MAX_HEAD_BYTES,
        "timeout_keep_alive": _KEEP_ALIVE_S,
        "timeout_graceful_shutdown": _SHUTDOWN_TIMEOUT_S,
        "log_level": "warning",
        "server_header": False,
        "log_config": None,
        "proxy_headers": bool(config.proxies),
        "forwarded_allow_ips": list(config.proxies),
        **(_tls_options(config.tls) if config.tls else {}),
        **(_client_tls_options(config.client_ca) if config.tls and config.client_ca else {}),
    }


def _client_tls_options(authority: Path) -> dict[str, Any]:
    """Ask clients for a certificate: guards have one, browsers and programs need none."""
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_verify_locations(authority)
    except (OSError, ssl.SSLError) as error:
        help = "give the certificates of your authority for guards, as PEM"
        raise InputError(f"TLS: {error}", path=str(authority), help=help) from None
    return {"ssl_ca_certs": str(authority), "ssl_cert_reqs": ssl.CERT_OPTIONAL}


def _tls_options(tls: Tls) -> dict[str, Any]:
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(tls.cert, tls.key)
    except (OSError, ssl.SSLError) as error:
        help = "give the certificate with its chain, and its key without password, as PEM"
        raise InputError(f"TLS: {error}", path=str(tls.cert), help=help) from None
    return {"ssl_certfile": str(tls.cert), "ssl_keyfile": str(tls.key)}
