"""The messages of an unpacked chunk of a ROS 1 bag (ROS wiki: Bags/Format/2.0)."""

from collections.abc import Mapping
from struct import Struct
from typing import NamedTuple

from rtron.sources.bag.common.limits import MAX_CHUNK_MESSAGES, DamageError
from rtron.sources.bag.common.reader import BagConnection, Message
from rtron.sources.bag.ros1.record import (
    CONNECTION,
    MESSAGE,
    SECOND,
    fields_of,
    number,
    operation,
    time,
)

_U32 = Struct("<I")
_HEADER = b"\x26\x00\x00\x00"
_CONN = b"\x09\x00\x00\x00conn="
_OP = b"\x04\x00\x00\x00op=\x02"
_TIME = b"\x0d\x00\x00\x00time="


class _Layout(NamedTuple):
    """A message's header up to the data's size: what stands before, between and after its values.

    Writers keep to one order of the fields, so a header is read whole: conn, seconds, nanoseconds.
    """

    whole: Struct
    before: bytes
    between: bytes
    after: bytes


def _layout(before: bytes, between: bytes, after: bytes) -> _Layout:
    code = f"<{len(before)}sI{len(between)}sII{len(after)}sI"
    return _Layout(Struct(code), before, between, after)


_LAYOUTS = (
    _layout(_HEADER + _CONN, _OP + _TIME, b""),
    _layout(_HEADER + _OP + _CONN, _TIME, b""),
    _layout(_HEADER + _CONN, _TIME, _OP),
)


def messages_of(chunk: bytes, connections: Mapping[int, BagConnection]) -> list[Message]:
    """Return a chunk's messages in the order of the file; raise DamageError or struct.error."""
    found: list[Message] = []
    at = 0
    while at < len(chunk):
        at = _alike(chunk, at, connections, found)
        if at < len(chunk):
            at = _single(chunk, at, connections, found)
    return found


def _alike(
    chunk: bytes, at: int, connections: Mapping[int, BagConnection], found: list[Message]
) -> int:
    """Add the messages that have one layout; return where the first that has not begins."""
    layout = _layout_at(chunk, at)
    unpack, head, before, between, after = layout.whole.unpack_from, layout.whole.size, *layout[1:]
    end = len(chunk)
    for _ in range(MAX_CHUNK_MESSAGES - len(found)):
        if at + head > end:
            return at
        was_before, conn, was_between, seconds, nanoseconds, was_after, size = unpack(chunk, at)
        if was_before != before or was_between != between or was_after != after:
            return at
        data_at = at + head
        at = data_at + size
        if at > end:
            raise DamageError("a message is longer than its chunk")
        found.append((seconds * SECOND + nanoseconds, connections[conn], chunk[data_at:at]))
    raise DamageError(f"more than {MAX_CHUNK_MESSAGES} messages in a chunk")


def _layout_at(chunk: bytes, at: int) -> _Layout:
    return next((each for each in _LAYOUTS if chunk.startswith(each.before, at)), _LAYOUTS[0])


def _single(
    chunk: bytes, at: int, connections: Mapping[int, BagConnection], found: list[Message]
) -> int:
    """Add one record, a message with whatever layout or a connection; return where it ends."""
    header, at = _sized(chunk, at)
    data, at = _sized(chunk, at)
    fields = fields_of(header)
    if operation(fields) == MESSAGE:
        found.append((time(fields, b"time"), connections[number(fields, b"conn")], data))
    elif operation(fields) != CONNECTION:
        raise DamageError("a chunk holds a record that is no message and no connection")
    return at


def _sized(chunk: bytes, at: int) -> tuple[bytes, int]:
    (size,) = _U32.unpack_from(chunk, at)
    end = at + 4 + size
    if end > len(chunk):
        raise DamageError("a record is longer than its chunk")
    return chunk[at + 4 : end], end
