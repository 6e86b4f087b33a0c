"""Calls to the private master, without waiting: one connection, one call at a time, a deadline."""

import logging
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import h11

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros1.tcp_server import set_socket_options

log = logging.getLogger(__name__)

OnResponse = Callable[[bytes | None], None]

TIMEOUT_S = 10.0
"""How long the private master may take for a call, seconds."""
MAX_RESPONSE_BYTES = 1 << 26
"""The longest answer accepted, bytes: the whole Parameter Server, for instance."""
_CHUNK = 1 << 18


class Upstream:
    """A connection to the private master that is made when it is needed, and kept."""

    def __init__(self, loop: EventLoop, host: str, port: int) -> None:
        self._loop = loop
        self._host, self._port = host, port
        self._sock: socket.socket | None = None
        self._http = h11.Connection(h11.CLIENT)
        self._send_buffer = memoryview(b"")
        self._body = bytearray()
        self._on_response: OnResponse | None = None
        self._call_count = 0

    def call(self, body: bytes, on_response: OnResponse) -> None:
        """Send an XML-RPC call; `on_response` gets the answer's body, or None if there is none."""
        self._call_count += 1
        self._on_response = on_response
        number = self._call_count
        self._loop.call_later(TIMEOUT_S, lambda: self._expire(number))
        try:
            self._send(body)
        except OSError as error:
            self._fail(error)

    def close(self) -> None:
        """Close the connection; nobody waits for an answer any more."""
        self._on_response = None
        self._disconnect()

    def _send(self, body: bytes) -> None:
        if self._sock is None:
            self._sock = self._connect()
        headers = [
            ("Host", self._host),
            ("Content-Type", "text/xml"),
            ("Content-Length", str(len(body))),
        ]
        head = self._http.send(h11.Request(method="POST", target="/RPC2", headers=headers)) or b""
        self._http.send(h11.Data(data=body))
        self._http.send(h11.EndOfMessage())
        self._send_buffer = memoryview(head + body)
        self._loop.await_writable(self._sock, self._writable)

    def _connect(self) -> socket.socket:
        sock = socket.socket()
        sock.settimeout(0)
        set_socket_options(sock)
        sock.connect_ex((self._host, self._port))
        self._http = h11.Connection(h11.CLIENT)
        self._loop.watch(sock, self._readable, self._fail)
        return sock

    def _writable(self) -> None:
        if self._sock is None:
            return
        with suppress(BlockingIOError):
            self._send_buffer = self._send_buffer[self._sock.send(self._send_buffer) :]
        if not self._send_buffer:
            self._loop.await_writable(self._sock, None)

    def _readable(self) -> None:
        if self._sock is None:
            return
        data = self._sock.recv(_CHUNK)
        try:
            self._http.receive_data(data)
            while self._handle_event(self._http.next_event()):
                pass
        except h11.ProtocolError as error:
            raise WireError(str(error)) from error

    def _handle_event(self, event: Any) -> bool:  # noqa: ANN401 - h11's events have no common base
        """Deal with an event; tell whether there may be another."""
        if isinstance(event, h11.Response) and event.status_code != 200:  # noqa: PLR2004 - OK
            raise WireError(f"the private master answers with HTTP {event.status_code}")
        if isinstance(event, h11.Data):
            self._body += event.data
            if len(self._body) > MAX_RESPONSE_BYTES:
                raise WireError("the private master's answer is too long")
        elif isinstance(event, h11.EndOfMessage):
            self._finish()
            return False
        elif isinstance(event, h11.ConnectionClosed):
            raise WireError("the private master closed the connection")
        return event is not h11.NEED_DATA and event is not h11.PAUSED

    def _finish(self) -> None:
        body = bytes(self._body)
        self._body.clear()
        if self._http.our_state is h11.DONE and self._http.their_state is h11.DONE:
            self._http.start_next_cycle()
        else:
            self._disconnect()
        self._deliver(body)

    def _expire(self, number: int) -> None:
        if self._on_response and number == self._call_count:
            self._fail(TimeoutError("timed out"))

    def _fail(self, error: Exception) -> None:
        if self._on_response:
            log.error("the private master does not answer: %s", error)
        self._disconnect()
        self._deliver(None)

    def _deliver(self, body: bytes | None) -> None:
        on_response, self._on_response = self._on_response, None
        if on_response:
            on_response(body)

    def _disconnect(self) -> None:
        sock, self._sock = self._sock, None
        self._body.clear()
        if sock:
            self._loop.forget(sock)
