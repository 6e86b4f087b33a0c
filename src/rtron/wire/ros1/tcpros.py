"""TCPROS on the wire: the connection header and length-prefixed frames (ROS wiki: TCPROS).

Sans-I/O: bytes in, values out. A header is a 4-byte little-endian length and fields of the form
`<4-byte length>name=value`; a message is a 4-byte little-endian length and its body.

The service is a stranger: its answer is bounded, and whatever it sends is an error, never a crash.
"""

import socket
import struct
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit

from rtron.errors import SourceError, WireError
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.xmlrpc import RefusalError, ros_call

LENGTH = struct.Struct("<I")
MAX_HEADER = 1 << 20
"""The longest connection header accepted, bytes; a message definition is the long part of it."""
MAX_FRAME = 1 << 26
"""The longest message accepted, bytes."""


def encode_header(fields: Mapping[str, str]) -> bytes:
    """Return a connection header with its length in front."""
    parts = (f"{name}={value}".encode() for name, value in fields.items())
    body = b"".join(LENGTH.pack(len(part)) + part for part in parts)
    return LENGTH.pack(len(body)) + body


def decode_header(body: bytes) -> dict[str, str]:
    """Return the fields of a header without its own length; WireError if it is malformed."""
    return dict(_field(part) for part in _parts(body))


def _parts(body: bytes) -> Iterator[bytes]:
    at = 0
    while at < len(body):
        if at + LENGTH.size > len(body):
            raise WireError("connection header ends inside a field's length")
        end = at + LENGTH.size + LENGTH.unpack_from(body, at)[0]
        if end > len(body):
            raise WireError("connection header ends inside a field")
        yield body[at + LENGTH.size : end]
        at = end


def _field(part: bytes) -> tuple[str, str]:
    name, equals, value = part.partition(b"=")
    if not equals or not name:
        raise WireError("connection header has a field without a name")
    return name.decode(errors="replace"), value.decode(errors="replace")


def frame_length(prefix: bytes | bytearray | memoryview, limit: int) -> int:
    """Return the length that a 4-byte prefix announces, WireError if it is over `limit` bytes."""
    length: int = LENGTH.unpack_from(prefix)[0]
    if length > limit:
        raise WireError(f"a length of {length} bytes is announced, the limit is {limit}")
    return length


class FrameReader:
    """Cuts a byte stream into frames, each kept with its length prefix so that it can go on as is.

    Memory grows with the bytes that arrived, never with a length that was only announced.
    """

    __slots__ = ("_buffer", "_limit", "missing", "skippable")

    def __init__(self, limit: int = MAX_FRAME) -> None:
        self._buffer = bytearray()
        self._limit = limit
        self.missing = 0
        """How many bytes the frame that has begun still lacks, as far as that is known."""
        self.skippable = 0
        """How many of these nobody needs: none."""

    def feed(self, data: bytes) -> list[bytes]:
        """Take what arrived; return the frames that are complete, each prefix included."""
        if not self._buffer and self._is_one_frame(data):
            return [data]
        buffer = self._buffer
        buffer += data
        frames = []
        at = 0
        while (end := self._frame_end(at)) and end <= len(buffer):
            frames.append(bytes(memoryview(buffer)[at:end]))
            at = end
        self.missing = max(0, end - len(buffer))
        if at:
            del buffer[:at]
        return frames

    def skip(self, count: int) -> list[bytes]:
        """Do nothing: every byte is kept."""
        del count
        return []

    def _is_one_frame(self, data: bytes) -> bool:
        prefixed = len(data) >= LENGTH.size
        return prefixed and frame_length(data, self._limit) + LENGTH.size == len(data)

    def _frame_end(self, at: int) -> int:
        """Return where the frame at `at` ends, or 0 while its prefix is not there."""
        if at + LENGTH.size > len(self._buffer):
            return 0
        prefix = bytes(self._buffer[at : at + LENGTH.size])
        return at + LENGTH.size + frame_length(prefix, self._limit)


class FrameBeginReader:
    """Cuts a byte stream into frames and keeps the first `size` bytes of each, with a new prefix.

    A frame is given when its end has come. What is not kept need not be read: `skippable` bytes of
    the stream may be left out and told to `skip`.
    """

    __slots__ = ("_buffer", "_frame", "_limit", "_size", "missing", "skippable")

    def __init__(self, size: int, limit: int = MAX_FRAME) -> None:
        self._buffer = bytearray()
        self._frame = b""
        self._size = size
        self._limit = limit
        self.missing = 0
        self.skippable = 0

    def feed(self, data: bytes) -> list[bytes]:
        """Take what arrived; return the beginnings of the frames that are complete.

        WireError if a frame is longer than the limit.
        """
        self._buffer += data
        frames = []
        while True:
            frames += self.skip(self._drop())
            if self.skippable or not self._begin():
                return frames

    def skip(self, count: int) -> list[bytes]:
        """Leave out bytes of the frame that has begun; return it if that was its end."""
        self.skippable -= count
        if self.skippable or not self._frame:
            return []
        frame, self._frame = self._frame, b""
        return [frame]

    def _drop(self) -> int:
        count = min(self.skippable, len(self._buffer))
        del self._buffer[:count]
        return count

    def _begin(self) -> bool:
        """Begin the next frame; False if its beginning is not there."""
        if len(self._buffer) < LENGTH.size:
            return False
        length = frame_length(self._buffer, self._limit)
        end = LENGTH.size + min(length, self._size)
        if len(self._buffer) < end:
            return False
        body = bytes(self._buffer[LENGTH.size : end])
        self._frame, self.skippable = LENGTH.pack(len(body)) + body, length - len(body)
        del self._buffer[:end]
        return True


_MAX_REASON = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceCall:
    """A call: `caller` is the name of the node that makes it, `request` has its length in front."""

    master: str
    caller: str
    service: str
    type: str
    md5sum: str
    request: bytes
    max_response: int
    timeout: float
    """Seconds."""


def call_service(call: ServiceCall, network: Network = HOST_NETWORK) -> bytes:
    """Return the response to a call, its length in front.

    SourceError if nobody offers the service, it does not answer in time, or it says no; WireError
    if it breaks the protocol or its answer is too long.
    """
    deadline = time.monotonic() + call.timeout
    address = _address(call, network)
    try:
        with network.connect(address, call.timeout) as connection:
            connection.sendall(encode_header(_header(call)))
            _check_answer(call, _receive_frame(connection, MAX_HEADER, deadline))
            connection.sendall(call.request)
            return _receive_response(call, connection, deadline)
    except OSError as error:
        raise SourceError(f"{call.service} does not answer: {error}") from error


def _address(call: ServiceCall, network: Network) -> tuple[str, int]:
    params = (call.caller, call.service)
    try:
        uri = ros_call(call.master, "lookupService", *params, timeout=call.timeout, network=network)
    except RefusalError:
        raise SourceError(f"nobody offers {call.service}") from None
    try:
        where = urlsplit(str(uri))
        if where.scheme == "rosrpc" and where.hostname and where.port:
            return where.hostname, where.port
    except ValueError as error:
        raise WireError(f"{call.service} is at no address: {error}") from error
    raise WireError(f"{call.service} is at no address: {str(uri)[:80]!r}")


def _header(call: ServiceCall) -> dict[str, str]:
    return {
        "callerid": call.caller,
        "service": call.service,
        "type": call.type,
        "md5sum": call.md5sum,
    }


def _check_answer(call: ServiceCall, header: bytes) -> None:
    error = decode_header(header[LENGTH.size :]).get("error")
    if error:
        raise SourceError(f"{call.service} refuses: {error[:_MAX_REASON]}")


def _receive_response(call: ServiceCall, connection: socket.socket, deadline: float) -> bytes:
    is_success = _receive_exactly(connection, 1, deadline) != b"\0"
    frame = _receive_frame(connection, call.max_response, deadline)
    if is_success:
        return frame
    reason = frame[LENGTH.size :].decode(errors="replace")[:_MAX_REASON]
    raise SourceError(f"{call.service} has failed: {reason}")


def _receive_frame(connection: socket.socket, limit: int, deadline: float) -> bytes:
    prefix = _receive_exactly(connection, LENGTH.size, deadline)
    return prefix + _receive_exactly(connection, frame_length(prefix, limit), deadline)


def _receive_exactly(connection: socket.socket, size: int, deadline: float) -> bytes:
    data = bytearray()
    while len(data) < size:
        left = deadline - time.monotonic()
        if left <= 0:
            raise TimeoutError("timed out")
        connection.settimeout(left)
        part = connection.recv(min(size - len(data), 1 << 16))
        if not part:
            raise WireError("the service has closed the connection")
        data += part
    return bytes(data)
