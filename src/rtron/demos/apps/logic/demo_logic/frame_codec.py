"""Frames of the device protocol: `!II` (bytes of head and of blob), a JSON object, raw bytes."""

import json
import struct
from collections.abc import Callable
from typing import Any

Head = dict[str, Any]
Frame = tuple[Head, bytes]
MAX_HEAD, MAX_BLOB = 64 * 1024, 1024 * 1024
_LENGTHS = struct.Struct("!II")


class BrokenFrameError(Exception):
    """The other side sent what is no frame."""


def encode(head: Head, blob: bytes = b"") -> bytes:
    """Return a frame; ValueError if the head has NaN or infinity, or a part is too long."""
    text = json.dumps(head, allow_nan=False).encode()
    if len(text) > MAX_HEAD or len(blob) > MAX_BLOB:
        raise ValueError(f"too long for a frame: {len(text)} and {len(blob)} bytes")
    return _LENGTHS.pack(len(text), len(blob)) + text + blob


def read(exactly: Callable[[int], bytes]) -> Frame:
    """Return the next frame; `exactly(n)` gives n bytes or raises."""
    head, blob = _LENGTHS.unpack(exactly(_LENGTHS.size))
    if head > MAX_HEAD or blob > MAX_BLOB:
        raise BrokenFrameError(f"a frame of {head} and {blob} bytes is too long")
    return _head(exactly(head)), exactly(blob)


def _head(text: bytes) -> Head:
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise BrokenFrameError(f"the head of a frame is no JSON: {error}") from error
    if not isinstance(value, dict):
        raise BrokenFrameError("the head of a frame is no JSON object")
    return value
