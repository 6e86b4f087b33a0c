"""Frames of the device protocol: `!II` (bytes of head and of blob), a JSON object, raw bytes.

What comes in is a stranger's: whatever is no frame raises WireError, and its connection ends.
"""

import json
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

from rtron.errors import WireError

MAX_HEAD, MAX_BLOB = 64 * 1024, 1024 * 1024
_LENGTHS = struct.Struct("!II")

Head = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class DeviceFrame:
    """A message: a JSON object, and raw bytes that may be none."""

    head: dict[str, Any]
    blob: bytes = b""


def encode_frame(head: Head, blob: bytes = b"") -> bytes:
    """Return a frame's bytes; ValueError for NaN, infinity, or a part that is too long."""
    text = json.dumps(head, allow_nan=False, separators=(",", ":")).encode()
    if len(text) > MAX_HEAD or len(blob) > MAX_BLOB:
        raise ValueError(f"too long for a frame: {len(text)} and {len(blob)} bytes")
    return b"".join((_LENGTHS.pack(len(text), len(blob)), text, blob))


class FrameParser:
    """Makes frames of the bytes of one connection, however they are cut.

    A peer whose frames have no blobs is read with `max_blob` 0. After a WireError the parser is
    of no further use.
    """

    def __init__(self, max_blob: int = MAX_BLOB) -> None:
        self._max_blob = max_blob
        self._bytes = bytearray()

    def feed(self, data: bytes) -> Iterator[DeviceFrame]:
        """Yield the frames that are complete with `data`."""
        self._bytes += data
        while (size := self._size()) is not None:
            head, blob = size
            start = _LENGTHS.size + head
            if len(self._bytes) < start + blob:
                return
            taken = bytes(self._bytes[: start + blob])
            del self._bytes[: start + blob]
            yield DeviceFrame(_parse_head(taken[_LENGTHS.size : start]), taken[start:])

    def _size(self) -> tuple[int, int] | None:
        if len(self._bytes) < _LENGTHS.size:
            return None
        head, blob = _LENGTHS.unpack_from(self._bytes)
        if head > MAX_HEAD or blob > self._max_blob:
            raise WireError(f"a frame of {head} and {blob} bytes is too long")
        return head, blob


def _parse_head(text: bytes) -> dict[str, Any]:
    try:
        value = json.loads(text.decode("utf-8"), parse_constant=_refused)
    except (ValueError, RecursionError) as error:
        raise WireError(f"the head of a frame is no JSON: {str(error)[:100]}") from error
    if not isinstance(value, dict):
        raise WireError("the head of a frame is no JSON object")
    return value


def _refused(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no JSON")
