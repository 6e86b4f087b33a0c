"""HTTP requests, XML-RPC ones for instance, served on the loop, one by one on each connection."""

import logging
import socket
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import h11

from rtron.errors import WireError
from rtron.guard.core.event_loop import Loop
from rtron.wire.ros1.xmlrpc import decode_call, encode_response

log = logging.getLogger(__name__)

Dispatch = Callable[[str, tuple[Any, ...]], list[Any]]
Serve = Callable[[bytes], None]

_IDLE_S = 30.0
_CHUNK = 1 << 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """The longest request, and the most of our answers that may wait for the caller, in bytes."""

    request: int = 1 << 16
    unread: int = 1 << 20


SLAVE_BOUNDS = Bounds()


class Budget:
    """How many bytes of long requests all connections together may hold."""

    def __init__(self, most: int) -> None:
        self._left = most

    def take(self, size: int) -> None:
        """Hold some more; WireError, and nothing is held, if that is too much."""
        if size > self._left:
            raise WireError("too much is being asked at once")
        self._left -= size

    def release(self, size: int) -> None:
        """Hold this much less."""
        self._left += size


class HttpConnection:
    """One HTTP connection; `serve` takes the body of each request, `reply` answers it, also later.

    Bad requests close it, slow ones are given up; `closed` hears of its end. What a
    request has beyond 64 KiB counts in the `budget` until it is answered; short ones are never
    refused for the long ones of others.
    """

    def __init__(
        self,
        loop: Loop,
        sock: socket.socket,
        serve: Serve,
        bounds: Bounds = SLAVE_BOUNDS,
        budget: Budget | None = None,
    ) -> None:
        self.closed: Callable[[], None] = lambda: None
        self._loop = loop
        self._sock = sock
        self._serve = serve
        self._bounds = bounds
        self._http = h11.Connection(h11.SERVER)
        self._budget = budget or Budget(bounds.request)
        self._held = 0
        self._body = bytearray()
        self._out = b""
        self._busy = False
        self._closed = False
        loop.watch(sock, self._readable, self._broken)
        loop.call_later(_IDLE_S, self._expire)

    def reply(self, body: bytes) -> None:
        """Answer the request that was served last; nothing if its caller has left."""
        if not self._closed:
            self._or_break(lambda: self._send_answer(body))

    def _hold(self, size: int) -> None:
        if size > self._held:
            self._budget.take(size - self._held)
            self._held = size

    def _release(self) -> None:
        self._budget.release(self._held)
        self._held = 0

    def _send_answer(self, body: bytes) -> None:
        self._release()
        headers = [("Content-Type", "text/xml"), ("Content-Length", str(len(body)))]
        self._write(self._http.send(h11.Response(status_code=200, headers=headers)))
        self._write(self._http.send(h11.Data(data=body)))
        self._write(self._http.send(h11.EndOfMessage()))
        if self._http.our_state is h11.DONE and self._http.their_state is h11.DONE:
            self._http.start_next_cycle()
            self._loop.after(lambda: self._or_break(self._take_events))
        elif not self._out:
            self.close()

    def _readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        if not data:
            self.close()
        elif len(self._http.trailing_data[0]) > _CHUNK:
            raise WireError("the caller does not wait for its answers")
        else:
            self._http.receive_data(data)
            self._or_break(self._take_events)

    def _take_events(self) -> None:
        while not self._closed and self._take(self._http.next_event()):
            pass

    def _or_break(self, action: Callable[[], None]) -> None:
        """Do what may fail while no caller of ours is there to hear of it."""
        try:
            action()
        except (h11.ProtocolError, OSError, WireError) as error:
            self._broken(error)

    def _take(self, event: Any) -> bool:  # noqa: ANN401 - h11's events have no common base
        """Deal with an event; tell whether there may be another."""
        if isinstance(event, h11.Data):
            self._body += event.data
            if len(self._body) > self._bounds.request:
                raise WireError("XML-RPC request too long")
            self._hold(len(self._body) - _CHUNK)
        elif isinstance(event, h11.EndOfMessage):
            self._busy = True
            body = bytes(self._body)
            self._body.clear()
            self._serve(body)
        elif isinstance(event, h11.ConnectionClosed):
            self.close()
            return False
        return event is not h11.NEED_DATA and event is not h11.PAUSED

    def _write(self, data: bytes | None) -> None:
        if self._closed or not data:
            return
        if not self._out:
            data = data[self._send(data) :]
        self._out += data
        if len(self._out) > self._bounds.unread:
            raise WireError("the caller does not read its answers")
        if self._out:
            self._loop.await_writable(self._sock, self._writable)

    def _writable(self) -> None:
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

    def _expire(self) -> None:
        if self._closed:
            return
        if not self._busy:
            self.close()
            return
        self._busy = False
        self._loop.call_later(_IDLE_S, self._expire)

    def close(self) -> None:
        """Close the connection; a second time does nothing."""
        if not self._closed:
            self._closed = True
            self._release()
            self._body.clear()
            self._loop.forget(self._sock)
            self.closed()

    def _broken(self, error: Exception) -> None:
        log.info("XML-RPC connection closed: %s", error)
        self.close()


class XmlRpcConnection(HttpConnection):
    """A connection to a slave API, each call answered at once."""

    def __init__(self, loop: Loop, sock: socket.socket, dispatch: Dispatch) -> None:
        super().__init__(loop, sock, self._answer)
        self._dispatch = dispatch

    def _answer(self, body: bytes) -> None:
        method, params = decode_call(body)
        self.reply(encode_response(self._dispatch(method, params)))
