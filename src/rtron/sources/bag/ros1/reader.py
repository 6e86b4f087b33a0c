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
from typing import NamedTuple

from rtron.errors import InputError
from rtron.sources.bag.common.compression import unpack
from rtron.sources.bag.common.limits import (
    MAX_CHUNK,
    MAX_CONNECTIONS,
    MAX_HEADER,
    MAX_INDEX,
    Allowance,
    DamageError,
    damaged,
    opened,
)
from rtron.sources.bag.common.reader import BagConnection, BagReading, Message
from rtron.sources.bag.common.time_order import in_time_order, sorted_by_time
from rtron.sources.bag.ros1.chunk import messages_of
from rtron.sources.bag.ros1.record import (
    BAG,
    CHUNK,
    CHUNK_INFO,
    CONNECTION,
    Fields,
    RecordFile,
    fields_of,
    number,
    operation,
    text,
    time,
)

_MAGIC = b"#ROSBAG V2.0\n"
_REINDEX = "`rosbag reindex FILE` makes its index anew"


class _Chunk(NamedTuple):
    start: int
    at: int


@dataclass(frozen=True, slots=True)
class _Index:
    connections: Mapping[int, BagConnection]
    chunks: tuple[_Chunk, ...]


def read_ros1_bag(path: Path) -> BagReading:
    """Return a ROS 1 bag's connections and the way to its messages.

    Raise InputError if the file is no bag of version 2.0, was not closed, or is damaged.
    """
    with opened(path) as stream, _faults_named(path):
        index = _read_index(stream, path)
    return BagReading(
        path=path,
        connections=tuple(index.connections.values()),
        messages=partial(_messages, path, index),
    )


@contextmanager
def _faults_named(path: Path) -> Iterator[None]:
    """Turn what a damaged record causes into an InputError (UnicodeDecodeError is a ValueError)."""
    try:
        yield
    except struct.error:
        raise damaged(path, "a field has a wrong size", _REINDEX) from None
    except KeyError as error:
        raise damaged(path, f"a message of no connection ({error})", _REINDEX) from None
    except (ValueError, OSError) as error:
        raise damaged(path, str(error), _REINDEX) from None


def _read_index(stream: BufferedReader, path: Path) -> _Index:
    _check_magic(stream, path)
    records = RecordFile(stream)
    header = records.header()
    if operation(header) != BAG:
        raise DamageError("it does not begin with its header")
    if header.get(b"encryptor"):
        raise InputError("the bag is encrypted", path=str(path), help="`rosbag decrypt FILE`")
    start = number(header, b"index_pos")
    if not start:
        raise InputError("the bag was not closed and has no index", path=str(path), help=_REINDEX)
    _seek(stream, start)
    index = _records_of_index(records)
    counts = (number(header, b"conn_count"), number(header, b"chunk_count"))
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


def _seek(stream: BufferedReader, at: int) -> None:
    size = stream.seek(0, 2)
    if at > size:
        raise DamageError("it is cut off")
    stream.seek(at)


def _records_of_index(records: RecordFile) -> _Index:
    connections: dict[int, BagConnection] = {}
    chunks: dict[int, _Chunk] = {}
    while not records.at_end():
        header, data = records.header(), records.data(MAX_INDEX)
        if operation(header) == CONNECTION:
            connections[number(header, b"conn")] = _connection(header, fields_of(data))
        elif operation(header) == CHUNK_INFO:
            chunk = _Chunk(time(header, b"start_time"), number(header, b"chunk_pos"))
            chunks[chunk.at] = chunk
        else:
            raise DamageError("its index holds a record of another kind")
        if len(connections) > MAX_CONNECTIONS:
            raise DamageError(f"more than {MAX_CONNECTIONS} connections")
    return _Index(connections, tuple(sorted(chunks.values())))


def _connection(header: Fields, fields: Fields) -> BagConnection:
    """Return a connection; a definition's comments may be in any encoding."""
    return BagConnection(
        topic=text(header, b"topic"),
        type=text(fields, b"type"),
        encoding="ros1",
        md5sum=text(fields, b"md5sum"),
        definition=fields.get(b"message_definition", b"").decode(errors="replace"),
        definition_format="ros1msg",
        callerid=fields.get(b"callerid", b"").decode(),
        latching=fields.get(b"latching") == b"1",
    )


def _messages(path: Path, index: _Index) -> Iterator[Message]:
    with opened(path) as stream:
        allowance = Allowance.of(path, stream.seek(0, 2))
        batches = (_batch(stream, chunk, index, allowance) for chunk in index.chunks)
        yield from in_time_order([chunk.start for chunk in index.chunks], batches, path)


def _batch(
    stream: BufferedReader, chunk: _Chunk, index: _Index, allowance: Allowance
) -> list[Message]:
    with _faults_named(allowance.path):
        _seek(stream, chunk.at)
        record = RecordFile(stream, MAX_HEADER + MAX_CHUNK)
        header = record.header()
        if operation(header) != CHUNK:
            raise DamageError("its index points to no chunk")
        size = number(header, b"size")
        allowance.spend(size)
        data = unpack(text(header, b"compression"), record.data(MAX_CHUNK), size)
        return sorted_by_time(messages_of(data, index.connections))
