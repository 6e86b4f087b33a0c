"""HTTP connections on the event loop, each serving one request after the other."""

import logging
import socket
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import h11

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.wire.ros1.xmlrpc import decode_call, encode_response

log = logging.getLogger(__name__)

CallHandler = Callable[[str, tuple[Any, ...]], list[Any]]
RequestHandler = Callable[[bytes], None]

_IDLE_TIMEOUT_S = 30.0
_CHUNK = 1 << 16


@dataclass(frozen=True, slots=True, kw_only=True)
class HttpLimits:
    """The longest request, and the most response data that may wait for the client, in bytes."""

    request: int = 1 << 16
    response: int = 1 << 20


SLAVE_LIMITS = HttpLimits()


class MemoryBudget:
    """How many bytes of long requests all connections together may hold."""

    def __init__(self, limit: int) -> None:
        self._left = limit

    def take(self, size: int) -> None:
        """Take `size` bytes; WireError, and none are taken, if fewer are left."""
        if size > self._left:
            raise WireError("too much is being asked at once")
        self._left -= size

    def release(self, size: int) -> None:
        """Give back `size` bytes."""
        self._left += size


class HttpConnection:
    """One HTTP connection: `on_request` takes each request's body, `reply` answers, also later.

    A bad or slow request closes it; `on_close` is called at its end. The part of a request beyond
    64 KiB counts in the `budget` until it is answered, so long requests never make short ones fail.
    """

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        on_request: RequestHandler,
        limits: HttpLimits = SLAVE_LIMITS,
        budget: MemoryBudget | None = None,
    ) -> None:
        self.on_close: Callable[[], None] = lambda: None
        self._loop = loop
        self._sock = sock
        self._on_request = on_request
        self._limits = limits
        self._http = h11.Connection(h11.SERVER)
        self._budget = budget or MemoryBudget(limits.request)
        self._reserved_bytes = 0
        self._body = bytearray()
        self._out = b""
        self._is_busy = False
        self._is_closed = False
        loop.watch(sock, self._on_readable, self._on_error)
        loop.call_later(_IDLE_TIMEOUT_S, self._close_if_idle)

    def reply(self, body: bytes) -> None:
        """Answer the last request; do nothing if its client has left."""
        if not self._is_closed:
            self._close_on_error(lambda: self._send_answer(body))

    def _reserve(self, size: int) -> None:
        if size > self._reserved_bytes:
            self._budget.take(size - self._reserved_bytes)
            self._reserved_bytes = size

    def _release(self) -> None:
        self._budget.release(self._reserved_bytes)
        self._reserved_bytes = 0

    def _send_answer(self, body: bytes) -> None:
        self._release()
        headers = [("Content-Type", "text/xml"), ("Content-Length", str(len(body)))]
        self._write(self._http.send(h11.Response(status_code=200, headers=headers)))
        self._write(self._http.send(h11.Data(data=body)))
        self._write(self._http.send(h11.EndOfMessage()))
        if self._http.our_state is h11.DONE and self._http.their_state is h11.DONE:
            self._http.start_next_cycle()
            self._loop.call_after_event(lambda: self._close_on_error(self._handle_events))
        elif not self._out:
            self.close()

    def _on_readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        if not data:
            self.close()
        elif len(self._http.trailing_data[0]) > _CHUNK:
            raise WireError("the caller does not wait for its answers")
        else:
            self._http.receive_data(data)
            self._close_on_error(self._handle_events)

    def _handle_events(self) -> None:
        while not self._is_closed and self._handle_event(self._http.next_event()):
            pass

    def _close_on_error(self, action: Callable[[], None]) -> None:
        """Run `action`; close the connection if it fails."""
        try:
            action()
        except (h11.ProtocolError, OSError, WireError) as error:
            self._on_error(error)

    def _handle_event(self, event: Any) -> bool:  # noqa: ANN401 - h11's events have no common base
        """Handle an event; return whether there may be another."""
        if isinstance(event, h11.Data):
            self._body += event.data
            if len(self._body) > self._limits.request:
                raise WireError("XML-RPC request too long")
            self._reserve(len(self._body) - _CHUNK)
        elif isinstance(event, h11.EndOfMessage):
            self._is_busy = True
            body = bytes(self._body)
            self._body.clear()
            self._on_request(body)
        elif isinstance(event, h11.ConnectionClosed):
            self.close()
            return False
        return event is not h11.NEED_DATA and event is not h11.PAUSED

    def _write(self, data: bytes | None) -> None:
        if self._is_closed or not data:
            return
        if not self._out:
            data = data[self._send(data) :]
        self._out += data
        if len(self._out) > self._limits.response:
            raise WireError("the caller does not read its answers")
        if self._out:
            self._loop.await_writable(self._sock, self._on_writable)

    def _on_writable(self) -> None:
        self._out = self._out[self._send(self._out) :]
        if self._out:
            return
        self._loop.await_writable(self._sock, None)
        if self._http.our_state is h11.MUST_CLOSE:
            self.close()

    def _send(self, data: bytes) -> int:
        try:
            return self._sock.send(data)
        except BlockingIOError:
            return 0

    def _close_if_idle(self) -> None:
        if self._is_closed:
            return
        if not self._is_busy:
            self.close()
            return
        self._is_busy = False
        self._loop.call_later(_IDLE_TIMEOUT_S, self._close_if_idle)

    def close(self) -> None:
        """Close the connection; a second call does nothing."""
        if not self._is_closed:
            self._is_closed = True
            self._release()
            self._body.clear()
            self._loop.forget(self._sock)
            self.on_close()

    def _on_error(self, error: Exception) -> None:
        log.info("XML-RPC connection closed: %s", error)
        self.close()


class XmlRpcConnection(HttpConnection):
    """A connection to a slave API, each call answered at once."""

    def __init__(self, loop: EventLoop, sock: socket.socket, dispatch: CallHandler) -> None:
        super().__init__(loop, sock, self._answer)
        self._dispatch = dispatch

    def _answer(self, body: bytes) -> None:
        method, params = decode_call(body)
        self.reply(encode_response(self._dispatch(method, params)))
