"""One question asked again and again over one connection that is kept open.

Nothing waits: `send_request` sends, `poll` looks whether the answer is there. The other side is a
stranger: what it sends is bounded, and slow, broken or surplus bytes end the connection (RFC 9112).
"""

import re
import socket
from dataclasses import dataclass
from xmlrpc.client import dumps

from rtron.errors import WireError

_MAX_RESPONSE_BYTES = 1 << 22
_MAX_HEAD_BYTES = 1 << 13
_CHUNK = 1 << 14
_HEAD_END = b"\r\n\r\n"
_OK = re.compile(rb"HTTP/1\.[01] 200[ \r]")
_LENGTH = re.compile(rb"\r\ncontent-length:[ \t]*(\d{1,9})[ \t]*\r\n", re.IGNORECASE)
_CLOSES = re.compile(rb"\r\nconnection:[ \t]*close[ \t]*\r\n", re.IGNORECASE)

SocketAddress = tuple[int, tuple[str, int]]
"""A socket's family, and where to connect to."""


@dataclass(frozen=True, slots=True)
class ServerAddress:
    """Where a server can be reached: the URI that was told, and what it resolves to."""

    uri: str
    address: SocketAddress


def encode_call(method: str, *params: str) -> bytes:
    """Return an XML-RPC call as the bytes of an HTTP request that keeps its connection."""
    body = dumps(params, method).encode()
    head = (
        "POST /RPC2 HTTP/1.1\r\nHost: rtron\r\nUser-Agent: rtron\r\nContent-Type: text/xml\r\n"
        f"Content-Length: {len(body)}\r\n\r\n"
    )
    return head.encode() + body


class XmlRpcPoller:
    """A connection to one server, made anew by `send_request` when the last one ended.

    `pending_since` is when the request was sent that waits for its response (ns), 0 if none does. A
    response that is the same as the last one, byte by byte, is the same object.
    """

    def __init__(self, request: bytes, max_bytes: int = _MAX_RESPONSE_BYTES) -> None:
        self._request = request
        self._max_bytes = max_bytes
        self._sock: socket.socket | None = None
        self._data = bytearray()
        self._is_sent = False
        self._last_response = self._last_body = b""
        self.pending_since = 0

    def send_request(self, server: ServerAddress, now: int) -> None:
        """Send the question; OSError if the server cannot be reached."""
        sock = self._sock
        if sock is None:
            sock = self._sock = _connect(server.address)
        self.pending_since = now
        self._send(sock)

    def poll(self) -> bytes | None:
        """Return the answer's body once it is there, None before.

        OSError or WireError, after which the connection is closed, if there will be none.
        """
        if self._sock is None or not self.pending_since:
            return None
        try:
            return self._receive(self._sock)
        except (OSError, WireError):
            self.close()
            raise

    def close(self) -> None:
        """End the connection, and wait for nothing."""
        sock, self._sock = self._sock, None
        self.pending_since = 0
        self._data.clear()
        if sock is not None:
            sock.close()

    def _send(self, sock: socket.socket) -> None:
        try:
            if sock.send(self._request) < len(self._request):
                raise WireError("takes no request")
        except BlockingIOError:  # it is not connected yet
            self._is_sent = False
            return
        except OSError:
            self.close()
            raise
        self._is_sent = True

    def _receive(self, sock: socket.socket) -> bytes | None:
        if not self._is_sent:
            self._send(sock)
        while self._is_sent:
            try:
                data = sock.recv(_CHUNK)
            except BlockingIOError:
                return None
            if data == self._last_response and data and not self._data:
                self.pending_since = 0
                return self._last_body
            self._data += data
            body = response_body(self._data, self._max_bytes, closed=not data)
            if body is not None:
                self._finish_response(body, closes=not data or closes_connection(self._data))
                return body
        return None

    def _finish_response(self, body: bytes, *, closes: bool) -> None:
        """Remember an answer if its connection goes on: the next one is mostly the same."""
        self._last_response, self._last_body = (b"", b"") if closes else (bytes(self._data), body)
        if closes:
            self.close()
        self.pending_since = 0
        self._data.clear()


def response_body(data: bytearray, max_bytes: int, *, closed: bool) -> bytes | None:
    """Return the body of an HTTP answer, None while it is not whole; WireError if it is none.

    Without a length the body lasts as long as the connection.
    """
    head = data.find(_HEAD_END)
    if head < 0:
        if closed or len(data) > _MAX_HEAD_BYTES:
            raise WireError("closed without an answer" if closed else "its answer is no HTTP")
        return None
    if not _OK.match(data):
        raise WireError("its answer is no HTTP 200")
    content_length = _LENGTH.search(data, 0, head + 2)
    body_start = head + len(_HEAD_END)
    length = int(content_length[1]) if content_length else len(data) - body_start
    if max(length, len(data) - body_start) > max_bytes:
        raise WireError(f"its answer is longer than {max_bytes} bytes")
    if len(data) - body_start > length:
        raise WireError("says more than it was asked")
    if closed and len(data) - body_start < length:
        raise WireError("closed before its answer was whole")
    is_complete = closed or (content_length is not None and len(data) - body_start == length)
    return bytes(data[body_start:]) if is_complete else None


def closes_connection(data: bytearray) -> bool:
    """Tell whether the server closes the connection after this answer."""
    head = data.find(_HEAD_END) + 2
    return data.startswith(b"HTTP/1.0") or _CLOSES.search(data, 0, head) is not None


def _connect(address: SocketAddress) -> socket.socket:
    family, host_port = address
    sock = socket.socket(family, socket.SOCK_STREAM)
    try:
        sock.settimeout(0)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        sock.connect(host_port)
    except BlockingIOError:
        pass  # the connection is being established
    except OSError:
        sock.close()
        raise
    return sock
