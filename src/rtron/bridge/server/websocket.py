"""A WebSocket on the event loop: the protocol is the library's (sans I/O), the socket is ours.

Compression is off, so no frame is a bomb; a message is bounded; what waits to be sent is bounded.
"""

import logging
import socket
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from typing import Protocol

from websockets.frames import CloseCode, Frame, Opcode
from websockets.http11 import Request, Response
from websockets.protocol import State
from websockets.server import ServerProtocol

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)
_quiet_log = log.getChild("protocol")
"""The library's own log, without what it says of each handshake: addresses with tokens."""
_quiet_log.setLevel(logging.WARNING)

_CHUNK = 1 << 14
"""What is read of a client at a time, bytes: others wait for up to 2,000 of its frames."""
_MAX_UNSENT = 1 << 20
"""The most bytes that may wait beside one message: a flood of pings makes them."""
_MAX_STRANGER = 1 << 15
"""The most that a client may send before it has signed in, bytes."""
_SEND_BUFFER = 1 << 17
"""What the kernel may keep for a slow reader, bytes: more of it is only older."""
_CLOSE_TIMEOUT_S = 3.0
_MAX_REASON_BYTES = 120


class SocketListener(Protocol):
    """Who serves a WebSocket."""

    @property
    def is_signed_in(self) -> bool:
        """Whether the client may send more than it takes to sign in."""

    def on_request(self, request: Request) -> Response:
        """Take the handshake; return the response that accepts or refuses it."""

    def on_text(self, text: str) -> None:
        """Take a message."""

    def on_binary(self) -> None:
        """Take that a message was binary, which nothing is."""

    def on_control(self) -> None:
        """Take that a ping, a pong, a goodbye, or a part of a message came."""

    def on_writable(self) -> None:
        """Send more: all that was sent so far has left."""

    def on_close(self, reason: str) -> None:
        """Take that the connection has ended."""


class ServerWebSocket:
    """One accepted connection, from its handshake to its end."""

    def __init__(
        self, loop: EventLoop, sock: socket.socket, listener: SocketListener, max_size: int
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._listener = listener
        self._protocol = ServerProtocol(max_size=max_size, logger=_quiet_log)
        self._message = bytearray()
        self._opcode = Opcode.TEXT
        self._unsent = bytearray()
        self._is_closing = self._is_ending = self._is_eof_due = False
        self._message_size = 0
        self._received = 0
        self._reason_given = ""
        self.is_closed = False
        self.last_received = loop.now()
        """When something came from the client last, ns."""
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER)
        loop.watch(sock, self._on_readable, self._on_error)

    @property
    def can_send(self) -> bool:
        """Whether a message can be sent that does not wait behind another one."""
        return self._is_open and not self._unsent

    @property
    def _is_open(self) -> bool:
        return not self.is_closed and self._protocol.state is State.OPEN

    def send(self, message: str | bytes) -> None:
        """Send a message, bytes as a binary one; the caller waits for `can_send`."""
        data = message if isinstance(message, bytes) else message.encode()
        self._message_size = len(data)
        if isinstance(message, bytes):
            self._protocol.send_binary(data)
        else:
            self._protocol.send_text(data)
        self._write()

    def ping(self) -> None:
        """Ask whether the client is there; its answer counts as heard."""
        if self._is_open:
            self._protocol.send_ping(b"")
            self._write()

    def close(self, code: int, reason: str) -> None:
        """Tell the client that the connection ends, and end it; a second call does nothing."""
        self._is_closing = True
        if not self._is_open:
            self._end(reason)
            return
        short = reason.encode()[:_MAX_REASON_BYTES].decode(errors="ignore")
        self._protocol.send_close(code, short)
        self._reason_given = reason
        self._write()

    def drop(self, reason: str) -> None:
        """End the connection at once; a second call does nothing."""
        self._end(reason)

    def _on_readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        self.last_received = self._loop.now()
        self._received += len(data)
        if self._received > _MAX_STRANGER and not self._listener.is_signed_in:
            raise WireError("too much before the sign-in")
        if data:
            self._protocol.receive_data(data)
        else:
            self._protocol.receive_eof()
        for event in self._protocol.events_received():
            self._handle(event)
        self._write()
        if not data:
            self._end(self._reason())

    def _handle(self, event: object) -> None:
        if self.is_closed or self._is_closing:
            return
        if isinstance(event, Request):
            self._answer_handshake(event)
        elif isinstance(event, Frame) and event.opcode in (Opcode.TEXT, Opcode.BINARY, Opcode.CONT):
            self._take_frame(event)
        elif isinstance(event, Frame):
            self._listener.on_control()

    def _answer_handshake(self, request: Request) -> None:
        self._protocol.send_response(self._listener.on_request(request))

    def accept(self, request: Request, headers: Mapping[str, str]) -> Response:
        """Return a response that accepts the handshake, with these headers besides."""
        response = self._protocol.accept(request)
        response.headers.update(headers)
        return response

    def reject(self, status: int, reason: str) -> Response:
        """Return a response that refuses the handshake."""
        return self._protocol.reject(status, f"{reason}\n")

    def _take_frame(self, frame: Frame) -> None:
        if frame.opcode is not Opcode.CONT:
            self._opcode = frame.opcode
        self._message += frame.data
        if not frame.fin:
            self._listener.on_control()
            return
        message, self._message = bytes(self._message), bytearray()
        if self._opcode is Opcode.BINARY:
            self._listener.on_binary()
            return
        try:
            text = message.decode()
        except UnicodeDecodeError:
            self.close(CloseCode.INVALID_DATA, "the frame is not UTF-8")
            return
        self._listener.on_text(text)

    def _write(self) -> None:
        """Send what the protocol has to send; what the kernel does not take waits."""
        if self.is_closed:
            return
        was_idle = not self._unsent
        for data in self._protocol.data_to_send():
            self._unsent += data
            self._is_eof_due = self._is_eof_due or not data
        if len(self._unsent) > _MAX_UNSENT + self._message_size:
            self._loop.call_after_event(partial(self._end, "the client does not read"))
            return
        if was_idle and self._unsent:
            self._flush()
        if self._protocol.close_expected():
            self._end_soon()

    def _flush(self) -> None:
        try:
            del self._unsent[: self._sock.send(self._unsent)]
        except BlockingIOError:
            pass
        except OSError as error:
            self._loop.call_after_event(partial(self._end, str(error)))
            return
        self._loop.await_writable(self._sock, self._on_writable if self._unsent else None)

    def _on_writable(self) -> None:
        self._flush()
        if self._unsent or self.is_closed:
            return
        self._write()
        if self.can_send:
            self._listener.on_writable()

    def _end_soon(self) -> None:
        """End the connection when the client has left or its time is over (RFC 6455, 7.1.1)."""
        if self._is_eof_due and not self._unsent:
            self._is_eof_due = False
            with suppress(OSError):  # the client has gone
                self._sock.shutdown(socket.SHUT_WR)
        if not self._is_ending:
            self._is_ending = True
            self._loop.call_later(_CLOSE_TIMEOUT_S, partial(self._end, self._reason()))

    def _reason(self) -> str:
        fault = self._protocol.handshake_exc or self._protocol.parser_exc
        is_fault = fault is not None and not isinstance(fault, EOFError)
        return str(fault) if is_fault else self._reason_given or "the client has left"

    def _on_error(self, error: Exception) -> None:
        self._end(str(error))

    def _end(self, reason: str) -> None:
        if not self.is_closed:
            self.is_closed = True
            self._loop.forget(self._sock)
            self._listener.on_close(reason)
