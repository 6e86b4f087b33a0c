"""One incident as one MCAP file, from the segments of the ring, some messages at a time."""

import os
import struct
from collections.abc import Iterable, Iterator, Mapping
from itertools import count
from pathlib import Path

from mcap.exceptions import McapError
from mcap.records import Channel as ChannelRecord
from mcap.records import Message, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from rtron.guard.incidents.ring import LIBRARY, Channel, ChannelWriter

PART = ".part"
"""What a file's name ends with that is not whole yet."""
_CHUNK_BYTES = 1 << 18
_LONGEST_RECORD = 1 << 24
_STEP = 200


def write_incident(
    segments: Iterable[Path],
    target: Path,
    span: tuple[int, int, int],
    metadata: Mapping[str, Mapping[str, str]],
    profile: str,
) -> Iterator[None]:
    """Write the messages of `span` to `target`, all or nothing.

    `span` is its begin, its end, and what is added to the ring's times, ns. Yield now and then, so
    that the caller can do something else. OSError if it cannot be written.
    """
    part = target.with_name(target.name + PART)
    try:
        with part.open("wb") as stream:
            writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.LZ4)
            writer.start(profile, LIBRARY)
            yield from _copy(segments, ChannelWriter(writer), span)
            for name, values in metadata.items():
                writer.add_metadata(name, dict(values))
            writer.finish()
            stream.flush()
            os.fsync(stream.fileno())
        part.rename(target)
    finally:
        part.unlink(missing_ok=True)


def _copy(
    segments: Iterable[Path], channels: ChannelWriter, span: tuple[int, int, int]
) -> Iterator[None]:
    begin, end, offset = span
    number = count(1)
    for path in segments:
        for channel, message in read_segment(path):
            if begin <= message.log_time <= end:
                channels.add(channel, message.log_time + offset, message.data)
            if next(number) % _STEP == 0:
                yield


def read_segment(path: Path) -> Iterator[tuple[Channel, Message]]:
    """Yield the messages of a segment and their channels, up to where it is torn."""
    try:
        with path.open("rb") as stream:
            yield from _messages(StreamReader(stream, record_size_limit=_LONGEST_RECORD))
    except (FileNotFoundError, McapError, struct.error, ValueError, KeyError):
        return  # it has made room meanwhile, or its end is torn


def _messages(reader: StreamReader) -> Iterator[tuple[Channel, Message]]:
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    for record in reader.records:
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, ChannelRecord):
            channels[record.id] = _channel(record, schemas[record.schema_id])
        elif isinstance(record, Message):
            yield channels[record.channel_id], record


def _channel(record: ChannelRecord, schema: Schema) -> Channel:
    return Channel(
        record.topic,
        record.message_encoding,
        schema.name,
        schema.encoding,
        schema.data.decode(),
        tuple(record.metadata.items()),
    )
