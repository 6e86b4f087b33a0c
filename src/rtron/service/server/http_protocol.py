"""The HTTP protocol of one connection: deadlines for requests and answers.

A client shows its certificate in TLS, or in the header of the proxy that speaks TLS.
"""

import asyncio
import base64
import binascii
import ssl
from collections.abc import Callable, Iterable
from typing import Any
from urllib.parse import unquote

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from rtron.service.server.connection_limit import ConnectionLimit, note_handshake

_HEAD_TIMEOUT_S = 10.0

_BODY_TIMEOUT_S = 25.0
"""Longer than the API waits for a body, so that it can say that it was too slow."""

_READER_TIMEOUT_S = 60.0
"""So long a client may leave 64 KiB of an answer unread."""

_READER, _END = object(), object()
"""What is awaited of a client beside parts of a request: to read, and to read what is the last."""
HEADER = b"client-cert"
STATE_KEY = "client_certificate"
"""Under this key the state of a WebSocket has the certificate (DER), None if none is shown."""


class LimitedHttpProtocol(H11Protocol):
    """HTTP with a deadline for each request and a limit of connections for each address.

    uvicorn's own protocol waits for ever, and one client could hold all connections.
    """

    def __init__(self, *arguments: Any, connection_limit: ConnectionLimit, **options: Any) -> None:  # noqa: ANN401 - uvicorn's
        """Make the protocol of one connection as uvicorn does."""
        super().__init__(*arguments, **options)
        self._connection_limit = connection_limit
        self._counted_address = ""
        self._awaited: object = None
        self._deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request, if the address has place for one more."""
        super().connection_made(transport)
        note_handshake(transport)
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
        is_proxy = self._connection_limit.is_proxy(self.client[0] if self.client else "")
        certificate = shown_certificate(self.transport, event.headers, is_proxy=is_proxy)
        self.app_state = {**self.app_state, STATE_KEY: certificate}
        super().handle_websocket_upgrade(event)

    def pause_writing(self) -> None:
        """Wait for the client to read."""
        super().pause_writing()
        self._await(_READER, _READER_TIMEOUT_S, self._abort)

    def resume_writing(self) -> None:
        """Go on waiting for what comes next."""
        super().resume_writing()
        self._restart_deadline()

    def _restart_deadline(self) -> None:
        """Wait for a head, or for a body: each has its time from its beginning on."""
        state = self.conn.their_state
        if self.transport.get_protocol() is not self:
            self._cancel_deadline()
        elif self.flow.write_paused:
            self._await(_READER, _READER_TIMEOUT_S, self._abort)
        elif self.transport.is_closing():
            self._await(_END, _READER_TIMEOUT_S, self._abort)
        elif state is h11.IDLE:
            self._await(state, _HEAD_TIMEOUT_S, self._close)
        elif state is h11.SEND_BODY:
            self._await(state, _BODY_TIMEOUT_S, self._abort)
        else:
            self._cancel_deadline()

    def _await(self, what: object, seconds: float, end: Callable[[], None]) -> None:
        """Wait for the client, and only as long as the place is not needed for others."""
        if self._awaited is not what:
            self._cancel_deadline()
            self._awaited = what
            self._connection_limit.add_waiting(self, self._abort)
            self._deadline = self.loop.call_later(seconds, end)

    def _close(self) -> None:
        """End once all is sent."""
        self.transport.close()
        self._await(_END, _READER_TIMEOUT_S, self._abort)

    def _abort(self) -> None:
        """End at once; the address may have another connection."""
        self._release()
        self.transport.abort()

    def _release(self) -> None:
        self._cancel_deadline()
        if self._counted_address:
            self._connection_limit.release(self._counted_address)
            self._counted_address = ""

    def _cancel_deadline(self) -> None:
        self._awaited = None
        self._connection_limit.remove_waiting(self)
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


class LimitedWebSocketProtocol(WebSocketsSansIOProtocol):
    """WebSockets with a limit of handshakes, and without an error in the log for each refused one.

    Handshakes are looked at one after the other: those of one address must not be in the way of all
    guards. uvicorn takes a handshake that got an answer of HTTP for forgotten, and says so.
    """

    def __init__(self, *arguments: Any, handshakes: ConnectionLimit, **options: Any) -> None:  # noqa: ANN401 - uvicorn's
        """Make the protocol of one connection as uvicorn does."""
        super().__init__(*arguments, **options)
        self._handshakes = handshakes
        self._counted_address: str | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin with the handshake, if the address has place for one more."""
        super().connection_made(transport)
        address = self.client[0] if self.client else ""
        if self._handshakes.acquire(address):
            self._counted_address = address
        else:
            transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take what comes, unless the connection is refused."""
        if not self.transport.is_closing():
            super().data_received(data)

    async def send(self, message: Any) -> None:  # noqa: ANN401 - uvicorn's
        """Send what the app says; with the end of an answer the handshake is over."""
        self._release()
        await super().send(message)
        if self.initial_response and self.close_sent:
            self.handshake_complete = True

    def connection_lost(self, exc: Exception | None) -> None:
        """Count no more."""
        self._release()
        super().connection_lost(exc)

    def _release(self) -> None:
        if self._counted_address is not None:
            self._handshakes.release(self._counted_address)
            self._counted_address = None


def shown_certificate(
    transport: asyncio.BaseTransport, headers: Iterable[tuple[bytes, bytes]], *, is_proxy: bool
) -> bytes | None:
    """Return the certificate that a client shows, DER; None if it shows none.

    What a proxy hands on counts from a proxy only, and what the proxy itself shows does not.
    """
    if is_proxy:
        values = [value for name, value in headers if name.lower() == HEADER]
        return _parse_header(values[0]) if len(values) == 1 else None
    tls = transport.get_extra_info("ssl_object")
    certificate: bytes | None = tls.getpeercert(binary_form=True) if tls else None
    return certificate


def _parse_header(value: bytes) -> bytes | None:
    """Return what RFC 9440 (`:base64:`), or nginx' $ssl_client_escaped_cert (PEM), hands on."""
    try:
        text = value.decode("ascii").strip()
        if text.startswith(":") and text.endswith(":"):
            return base64.b64decode(text[1:-1], validate=True) or None
        return ssl.PEM_cert_to_DER_cert(unquote(text)) if text else None
    except (ValueError, binascii.Error):
        return None
