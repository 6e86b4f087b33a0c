"""XML-RPC requests served on the loop, one after the other on each connection."""

import logging
import socket
from collections.abc import Callable
from typing import Any

import h11

from rtron.errors import WireError
from rtron.guard.transport.ros1.loop import Loop
from rtron.wire.xmlrpc import decode_call, encode_response

log = logging.getLogger(__name__)

Dispatch = Callable[[str, tuple[Any, ...]], list[Any]]

_MAX_REQUEST = 1 << 16
_MOST_UNREAD = 1 << 20
_IDLE_S = 30.0
_CHUNK = 1 << 16


class XmlRpcConnection:
    """One HTTP connection to a slave API; bad requests close it, slow ones are given up."""

    def __init__(self, loop: Loop, sock: socket.socket, dispatch: Dispatch) -> None:
        self._loop = loop
        self._sock = sock
        self._dispatch = dispatch
        self._http = h11.Connection(h11.SERVER)
        self._body = bytearray()
        self._out = b""
        self._busy = False
        self._closed = False
        loop.watch(sock, self._readable, self._broken)
        loop.call_later(_IDLE_S, self._expire)

    def _readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        try:
            self._http.receive_data(data)
            while self._take(self._http.next_event()):
                pass
        except h11.ProtocolError as error:
            raise WireError(str(error)) from error

    def _take(self, event: Any) -> bool:  # noqa: ANN401 - h11's events have no common base
        """Deal with an event; tell whether there may be another."""
        if isinstance(event, h11.Data):
            self._body += event.data
            if len(self._body) > _MAX_REQUEST:
                raise WireError("XML-RPC request too long")
        elif isinstance(event, h11.EndOfMessage):
            self._answer()
        elif isinstance(event, h11.ConnectionClosed):
            self._close()
            return False
        return event is not h11.NEED_DATA and event is not h11.PAUSED

    def _answer(self) -> None:
        self._busy = True
        method, params = decode_call(bytes(self._body))
        self._body.clear()
        self._reply(encode_response(self._dispatch(method, params)))

    def _reply(self, body: bytes) -> None:
        headers = [("Content-Type", "text/xml"), ("Content-Length", str(len(body)))]
        self._write(self._http.send(h11.Response(status_code=200, headers=headers)))
        self._write(self._http.send(h11.Data(data=body)))
        self._write(self._http.send(h11.EndOfMessage()))
        if self._http.our_state is h11.DONE and self._http.their_state is h11.DONE:
            self._http.start_next_cycle()
        elif not self._out:
            self._close()

    def _write(self, data: bytes | None) -> None:
        if self._closed or not data:
            return
        if not self._out:
            data = data[self._send(data) :]
        self._out += data
        if len(self._out) > _MOST_UNREAD:
            raise WireError("the caller does not read its answers")
        if self._out:
            self._loop.await_writable(self._sock, self._writable)

    def _writable(self) -> None:
        self._out = self._out[self._send(self._out) :]
        if self._out:
            return
        self._loop.await_writable(self._sock, None)
        if self._http.our_state is h11.MUST_CLOSE:
            self._close()

    def _send(self, data: bytes) -> int:
        try:
            return self._sock.send(data)
        except BlockingIOError:
            return 0

    def _expire(self) -> None:
        if self._closed:
            return
        if not self._busy:
            self._close()
            return
        self._busy = False
        self._loop.call_later(_IDLE_S, self._expire)

    def _close(self) -> None:
        self._closed = True
        self._loop.forget(self._sock)

    def _broken(self, error: Exception) -> None:
        log.info("XML-RPC connection closed: %s", error)
        self._close()
