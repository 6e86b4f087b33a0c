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
    opcode,
    parse_fields,
    time_field,
    uint_field,
)

_U32 = Struct("<I")
_HEADER = b"\x26\x00\x00\x00"
_CONN = b"\x09\x00\x00\x00conn="
_OP = b"\x04\x00\x00\x00op=\x02"
_TIME = b"\x0d\x00\x00\x00time="


class _HeaderLayout(NamedTuple):
    """A message's header up to the data's size: what stands before, between and after its values.

    Writers keep to one order of the fields, so a header is read whole: conn, seconds, nanoseconds.
    """

    header: Struct
    before: bytes
    between: bytes
    after: bytes


def _header_layout(before: bytes, between: bytes, after: bytes) -> _HeaderLayout:
    code = f"<{len(before)}sI{len(between)}sII{len(after)}sI"
    return _HeaderLayout(Struct(code), before, between, after)


_LAYOUTS = (
    _header_layout(_HEADER + _CONN, _OP + _TIME, b""),
    _header_layout(_HEADER + _OP + _CONN, _TIME, b""),
    _header_layout(_HEADER + _CONN, _TIME, _OP),
)


def decode_messages(chunk: bytes, connections: Mapping[int, BagConnection]) -> list[Message]:
    """Return a chunk's messages in the order of the file; raise DamageError or struct.error."""
    messages: list[Message] = []
    offset = 0
    while offset < len(chunk):
        offset = _decode_uniform(chunk, offset, connections, messages)
        if offset < len(chunk):
            offset = _decode_record(chunk, offset, connections, messages)
    return messages


def _decode_uniform(
    chunk: bytes, offset: int, connections: Mapping[int, BagConnection], messages: list[Message]
) -> int:
    """Add the messages that have one layout; return where the first that has not begins."""
    layout = _layout_of_header(chunk, offset)
    unpack, header_size, before, between, after = (
        layout.header.unpack_from,
        layout.header.size,
        *layout[1:],
    )
    end = len(chunk)
    for _ in range(MAX_CHUNK_MESSAGES - len(messages)):
        if offset + header_size > end:
            return offset
        was_before, conn, was_between, seconds, nanoseconds, was_after, size = unpack(chunk, offset)
        if was_before != before or was_between != between or was_after != after:
            return offset
        data_at = offset + header_size
        offset = data_at + size
        if offset > end:
            raise DamageError("a message is longer than its chunk")
        messages.append((seconds * SECOND + nanoseconds, connections[conn], chunk[data_at:offset]))
    raise DamageError(f"more than {MAX_CHUNK_MESSAGES} messages in a chunk")


def _layout_of_header(chunk: bytes, offset: int) -> _HeaderLayout:
    return next((each for each in _LAYOUTS if chunk.startswith(each.before, offset)), _LAYOUTS[0])


def _decode_record(
    chunk: bytes, offset: int, connections: Mapping[int, BagConnection], messages: list[Message]
) -> int:
    """Add one record, a message with whatever layout or a connection; return where it ends."""
    header, offset = _sized_bytes(chunk, offset)
    data, offset = _sized_bytes(chunk, offset)
    fields = parse_fields(header)
    if opcode(fields) == MESSAGE:
        messages.append(
            (time_field(fields, b"time"), connections[uint_field(fields, b"conn")], data)
        )
    elif opcode(fields) != CONNECTION:
        raise DamageError("a chunk holds a record that is no message and no connection")
    return offset


def _sized_bytes(chunk: bytes, offset: int) -> tuple[bytes, int]:
    (size,) = _U32.unpack_from(chunk, offset)
    end = offset + 4 + size
    if end > len(chunk):
        raise DamageError("a record is longer than its chunk")
    return chunk[offset + 4 : end], end
