"""One question asked again and again over one connection that is kept open.

Nothing waits: `ask` sends, `poll` looks whether the answer is there. The other side is a stranger:
what it sends is bounded, and slow, broken or surplus bytes end the connection (RFC 9112).
"""

import re
import socket
from dataclasses import dataclass
from xmlrpc.client import dumps

from rtron.errors import WireError

_MOST = 1 << 22
_MOST_HEAD = 1 << 13
_CHUNK = 1 << 14
_HEAD_END = b"\r\n\r\n"
_OK = re.compile(rb"HTTP/1\.[01] 200[ \r]")
_LENGTH = re.compile(rb"\r\ncontent-length:[ \t]*(\d{1,9})[ \t]*\r\n", re.IGNORECASE)
_CLOSES = re.compile(rb"\r\nconnection:[ \t]*close[ \t]*\r\n", re.IGNORECASE)

Address = tuple[int, tuple[str, int]]
"""A socket's family, and where to connect to."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a server can be reached: the URI that was told, and what it resolves to."""

    uri: str
    address: Address


def request(method: str, *params: str) -> bytes:
    """Return an XML-RPC call as the bytes of an HTTP request that keeps its connection."""
    body = dumps(params, method).encode()
    head = (
        "POST /RPC2 HTTP/1.1\r\nHost: rtron\r\nUser-Agent: rtron\r\nContent-Type: text/xml\r\n"
        f"Content-Length: {len(body)}\r\n\r\n"
    )
    return head.encode() + body


class Asker:
    """A connection to one server, made anew by `ask` when the last one ended.

    `since` is when the question was asked that waits for its answer (ns), 0 if none does. An answer
    that is the same as the last one, byte by byte, is the same object.
    """

    def __init__(self, question: bytes, most: int = _MOST) -> None:
        self._question = question
        self._most = most
        self._sock: socket.socket | None = None
        self._data = bytearray()
        self._sent = False
        self._last = self._last_body = b""
        self.since = 0

    def ask(self, place: Place, now: int) -> None:
        """Send the question; OSError if the server cannot be reached."""
        sock = self._sock
        if sock is None:
            sock = self._sock = _connecting(place.address)
        self.since = now
        self._send(sock)

    def poll(self) -> bytes | None:
        """Return the answer's body once it is there, None before.

        OSError or WireError, after which the connection is closed, if there will be none.
        """
        if self._sock is None or not self.since:
            return None
        try:
            return self._received(self._sock)
        except (OSError, WireError):
            self.close()
            raise

    def close(self) -> None:
        """End the connection, and wait for nothing."""
        sock, self._sock = self._sock, None
        self.since = 0
        self._data.clear()
        if sock is not None:
            sock.close()

    def _send(self, sock: socket.socket) -> None:
        try:
            if sock.send(self._question) < len(self._question):
                raise WireError("takes no request")
        except BlockingIOError:  # it is not connected yet
            self._sent = False
            return
        except OSError:
            self.close()
            raise
        self._sent = True

    def _received(self, sock: socket.socket) -> bytes | None:
        if not self._sent:
            self._send(sock)
        while self._sent:
            try:
                data = sock.recv(_CHUNK)
            except BlockingIOError:
                return None
            if data == self._last and data and not self._data:
                self.since = 0
                return self._last_body
            self._data += data
            body = body_of(self._data, self._most, ended=not data)
            if body is not None:
                self._answered(body, closes=not data or _ends(self._data))
                return body
        return None

    def _answered(self, body: bytes, *, closes: bool) -> None:
        """Remember an answer if its connection goes on: the next one is mostly the same."""
        self._last, self._last_body = (b"", b"") if closes else (bytes(self._data), body)
        if closes:
            self.close()
        self.since = 0
        self._data.clear()


def body_of(data: bytearray, most: int, *, ended: bool) -> bytes | None:
    """Return the body of an HTTP answer, None while it is not whole; WireError if it is none.

    Without a length the body lasts as long as the connection.
    """
    head = data.find(_HEAD_END)
    if head < 0:
        if ended or len(data) > _MOST_HEAD:
            raise WireError("closed without an answer" if ended else "its answer is no HTTP")
        return None
    if not _OK.match(data):
        raise WireError("its answer is no HTTP 200")
    told = _LENGTH.search(data, 0, head + 2)
    begin = head + len(_HEAD_END)
    length = int(told[1]) if told else len(data) - begin
    if max(length, len(data) - begin) > most:
        raise WireError(f"its answer is longer than {most} bytes")
    if len(data) - begin > length:
        raise WireError("says more than it was asked")
    if ended and len(data) - begin < length:
        raise WireError("closed before its answer was whole")
    whole = ended or (told is not None and len(data) - begin == length)
    return bytes(data[begin:]) if whole else None


def _ends(data: bytearray) -> bool:
    """Tell whether the server closes the connection after this answer."""
    head = data.find(_HEAD_END) + 2
    return data.startswith(b"HTTP/1.0") or _CLOSES.search(data, 0, head) is not None


def _connecting(address: Address) -> socket.socket:
    family, where = address
    sock = socket.socket(family, socket.SOCK_STREAM)
    try:
        sock.settimeout(0)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        sock.connect(where)
    except BlockingIOError:
        pass
    except OSError:
        sock.close()
        raise
    return sock
