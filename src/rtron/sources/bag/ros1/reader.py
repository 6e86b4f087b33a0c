"""A ROS 1 bag: its index, and its chunks one after the other (ROS wiki: Bags/Format/2.0).

Message by message it is never indexed: what is in memory is the chunk being read, and of others
what overlaps with it in time.
"""

import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from io import BufferedReader
from pathlib import Path
from struct import Struct
from typing import NamedTuple

from rtron.errors import InputError
from rtron.sources.bag.common.compression import decompress
from rtron.sources.bag.common.reader import (
    MAX_CHUNK_BYTES,
    MAX_CHUNK_MESSAGES,
    MAX_CONNECTIONS,
    MAX_HEADER_BYTES,
    MAX_INDEX_BYTES,
    BagConnection,
    BagReader,
    DamageError,
    DecompressionBudget,
    Message,
    damage_error,
    merge_by_time,
    open_bag_file,
    sort_by_time,
)
from rtron.sources.bag.ros1.record import (
    BAG_HEADER,
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    MESSAGE,
    SECOND,
    Fields,
    RecordReader,
    opcode,
    parse_fields,
    text_field,
    time_field,
    uint_field,
)

_MAGIC = b"#ROSBAG V2.0\n"
_REINDEX_HELP = "`rosbag reindex FILE` makes its index anew"


class _Chunk(NamedTuple):
    start: int
    offset: int


@dataclass(frozen=True, slots=True)
class _Index:
    connections: Mapping[int, BagConnection]
    chunks: tuple[_Chunk, ...]


def open_ros1_bag(path: Path) -> BagReader:
    """Return a ROS 1 bag's connections and the way to its messages.

    Raise InputError if the file is no bag of version 2.0, was not closed, or is damaged.
    """
    with open_bag_file(path) as stream, _damage_as_input_error(path):
        index = _read_index(stream, path)
    return BagReader(
        path=path,
        connections=tuple(index.connections.values()),
        messages=partial(_messages, path, index),
    )


@contextmanager
def _damage_as_input_error(path: Path) -> Iterator[None]:
    """Turn what a damaged record causes into an InputError (UnicodeDecodeError is a ValueError)."""
    try:
        yield
    except struct.error:
        raise damage_error(path, "a field has a wrong size", _REINDEX_HELP) from None
    except KeyError as error:
        raise damage_error(path, f"a message of no connection ({error})", _REINDEX_HELP) from None
    except (ValueError, OSError) as error:
        raise damage_error(path, str(error), _REINDEX_HELP) from None


def _read_index(stream: BufferedReader, path: Path) -> _Index:
    _check_magic(stream, path)
    records = RecordReader(stream)
    header = records.read_header()
    if opcode(header) != BAG_HEADER:
        raise DamageError("it does not begin with its header")
    if header.get(b"encryptor"):
        raise InputError("the bag is encrypted", path=str(path), help="`rosbag decrypt FILE`")
    start = uint_field(header, b"index_pos")
    if not start:
        raise InputError(
            "the bag was not closed and has no index", path=str(path), help=_REINDEX_HELP
        )
    _seek(stream, start)
    index = _read_index_records(records)
    counts = (uint_field(header, b"conn_count"), uint_field(header, b"chunk_count"))
    if counts != (len(index.connections), len(index.chunks)):
        raise DamageError("its index has not the number of entries that it should")
    return index


def _check_magic(stream: BufferedReader, path: Path) -> None:
    magic = stream.read(len(_MAGIC))
    if magic.startswith(b"#ROSBAG V") and magic != _MAGIC:
        help = "`rosbag reindex FILE` brings an old bag up to date"
        raise InputError("a bag of another version than 2.0", path=str(path), help=help)
    if magic != _MAGIC:
        raise InputError("no ROS 1 bag", path=str(path), help="is it the right file?")


def _seek(stream: BufferedReader, offset: int) -> None:
    size = stream.seek(0, 2)
    if offset > size:
        raise DamageError("it is cut off")
    stream.seek(offset)


def _read_index_records(records: RecordReader) -> _Index:
    connections: dict[int, BagConnection] = {}
    chunks: dict[int, _Chunk] = {}
    while not records.at_end():
        header, data = records.read_header(), records.read_data(MAX_INDEX_BYTES)
        if opcode(header) == CONNECTION:
            connections[uint_field(header, b"conn")] = _connection(header, parse_fields(data))
        elif opcode(header) == CHUNK_INFO:
            chunk = _Chunk(time_field(header, b"start_time"), uint_field(header, b"chunk_pos"))
            chunks[chunk.offset] = chunk
        else:
            raise DamageError("its index holds a record of another kind")
        if len(connections) > MAX_CONNECTIONS:
            raise DamageError(f"more than {MAX_CONNECTIONS} connections")
    return _Index(connections, tuple(sorted(chunks.values())))


def _connection(header: Fields, fields: Fields) -> BagConnection:
    """Return a connection; a definition's comments may be in any encoding."""
    return BagConnection(
        topic=text_field(header, b"topic"),
        type=text_field(fields, b"type"),
        encoding="ros1",
        md5sum=text_field(fields, b"md5sum"),
        definition=fields.get(b"message_definition", b"").decode(errors="replace"),
        definition_format="ros1msg",
        callerid=fields.get(b"callerid", b"").decode(),
        latching=fields.get(b"latching") == b"1",
    )


def _messages(path: Path, index: _Index) -> Iterator[Message]:
    with open_bag_file(path) as stream:
        budget = DecompressionBudget.for_file(path, stream.seek(0, 2))
        batches = (_chunk_messages(stream, chunk, index, budget) for chunk in index.chunks)
        yield from merge_by_time([chunk.start for chunk in index.chunks], batches, path)


def _chunk_messages(
    stream: BufferedReader, chunk: _Chunk, index: _Index, budget: DecompressionBudget
) -> list[Message]:
    with _damage_as_input_error(budget.path):
        _seek(stream, chunk.offset)
        record = RecordReader(stream, MAX_HEADER_BYTES + MAX_CHUNK_BYTES)
        header = record.read_header()
        if opcode(header) != CHUNK:
            raise DamageError("its index points to no chunk")
        size = uint_field(header, b"size")
        budget.spend(size)
        data = decompress(
            text_field(header, b"compression"), record.read_data(MAX_CHUNK_BYTES), size
        )
        return sort_by_time(decode_messages(data, index.connections))


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
