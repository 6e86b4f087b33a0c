"""TCPROS on the wire: the connection header and length-prefixed frames (ROS wiki: TCPROS).

Sans-I/O: bytes in, values out. A header is a 4-byte little-endian length and fields of the form
`<4-byte length>name=value`; a message is a 4-byte little-endian length and its body.
"""

import struct
from collections.abc import Iterator, Mapping

from rtron.errors import WireError

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
