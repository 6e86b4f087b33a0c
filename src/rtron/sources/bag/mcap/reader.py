"""An MCAP file, one chunk after the other (mcap.dev: MCAP specification)."""

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from io import BufferedReader
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bag.common.compression import unpack
from rtron.sources.bag.common.limits import MAX_CHUNK, Allowance, DamageError, damaged, opened
from rtron.sources.bag.common.reader import BagReading, Message
from rtron.sources.bag.common.time_order import in_time_order, sorted_by_time
from rtron.sources.bag.mcap.record import (
    CHUNK,
    DATA_END,
    MESSAGE,
    RECORD,
    Channels,
    Values,
    message_of,
    messages_of,
)
from rtron.sources.bag.mcap.summary import MAGIC, RECOVER, Chunk, Summary, read_summary


def read_mcap(path: Path) -> BagReading:
    """Return an MCAP file's connections and the way to its messages.

    A file of profile `ros1` names the publishers, one of `ros2` does not. Raise InputError if it
    is no MCAP, has no summary, or is damaged.
    """
    with opened(path) as stream, _faults_named(path):
        summary = read_summary(stream, path)
    return BagReading(
        path=path,
        connections=tuple(filter(None, summary.channels.values())),
        messages=partial(_messages, path, summary),
        left_out=tuple(summary.left_out.items()),
    )


@contextmanager
def _faults_named(path: Path) -> Iterator[None]:
    """Turn what a damaged record causes into an InputError (UnicodeDecodeError is a ValueError)."""
    try:
        yield
    except KeyError as error:
        raise damaged(path, f"a message of no channel ({error})", RECOVER) from None
    except (ValueError, struct.error, OSError) as error:
        raise damaged(path, str(error), RECOVER) from None


def _messages(path: Path, summary: Summary) -> Iterator[Message]:
    with opened(path) as stream:
        if not summary.chunks:
            yield from _unchunked(stream, path, summary.channels)
            return
        allowance = Allowance.of(path, stream.seek(0, 2))
        chunks = sorted(summary.chunks.values())
        batches = (_batch(stream, chunk, summary, allowance) for chunk in chunks)
        yield from in_time_order([chunk.start for chunk in chunks], batches, path)


def _batch(
    stream: BufferedReader, chunk: Chunk, summary: Summary, allowance: Allowance
) -> list[Message]:
    with _faults_named(allowance.path):
        allowance.spend(chunk.unpacked)
        values = _chunk_record(stream, chunk.at)
        values.take(16)
        if values.number(8) != chunk.unpacked:
            raise DamageError("its index and a chunk do not agree")
        values.take(4)
        compression, data = values.text(), values.block(8)
        unpacked = unpack(compression, data, chunk.unpacked)
        return sorted_by_time(messages_of(unpacked, summary.channels))


def _chunk_record(stream: BufferedReader, at: int) -> Values:
    if at > stream.seek(0, 2):
        raise DamageError("it is cut off")
    stream.seek(at)
    kind, values = _record(stream)
    if kind != CHUNK:
        raise DamageError("its index points to no chunk")
    return values


def _unchunked(stream: BufferedReader, path: Path, channels: Channels) -> Iterator[Message]:
    """Yield messages that stand in no chunk, as a recorder set to write fast leaves them."""
    stream.seek(len(MAGIC))
    last = 0
    while message := _next(stream, path, channels):
        if message[0] < last:
            help = "`mcap sort FILE -o OUT` brings its messages in the order of time"
            raise InputError("its messages are out of order", path=str(path), help=help)
        last = message[0]
        yield message


def _next(stream: BufferedReader, path: Path, channels: Channels) -> Message | None:
    """Return the next message that is of ROS, None at the end of the data."""
    with _faults_named(path):
        while True:
            kind, values = _record(stream)
            if kind == DATA_END:
                return None
            if kind == CHUNK:
                raise DamageError("its summary does not say where its chunks are")
            message = message_of(values, channels) if kind == MESSAGE else None
            if message:
                return message


def _record(stream: BufferedReader) -> tuple[int, Values]:
    kind, size = RECORD.unpack(stream.read(RECORD.size))
    if size > MAX_CHUNK:
        raise DamageError(f"a record of {size} bytes")
    data = stream.read(size)
    if len(data) < size:
        raise DamageError("it is cut off")
    return kind, Values(data)
