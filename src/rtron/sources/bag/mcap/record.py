"""Records of an MCAP file and the values in them (mcap.dev: MCAP specification, Records)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from io import BufferedReader
from pathlib import Path
from struct import Struct
from typing import NamedTuple, TypeAlias

from rtron.errors import InputError
from rtron.sources.bag.common.reader import (
    MAX_CHUNK_MESSAGES,
    MAX_INDEX_BYTES,
    BagConnection,
    DamageError,
    Encoding,
    Message,
    unknown_encoding,
)
from rtron.sources.bag.ros2.offered_qos import parse_offered_qos

FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX = 2, 3, 4, 5, 6, 8
METADATA, METADATA_INDEX, DATA_END = 12, 13, 15
RECORD = Struct("<BQ")
_MESSAGE = Struct("<BQHIQQ")
_MESSAGE_HEADER_SIZE = _MESSAGE.size - RECORD.size
_NUMBERS = {size: Struct(code) for size, code in ((2, "<H"), (4, "<I"), (8, "<Q"))}


Channels: TypeAlias = dict[int, BagConnection | None]


@dataclass(slots=True)
class FieldCursor:
    """A record's values, read one after the other; raise DamageError past its end."""

    data: bytes
    position: int = 0

    def read_uint(self, size: int) -> int:
        """Return a number of 2, 4 or 8 bytes."""
        (value,) = _NUMBERS[size].unpack(self.take(size))
        return int(value)

    def read_string(self) -> str:
        """Return a text."""
        return self.read_bytes(4).decode()

    def read_bytes(self, size_of_size: int) -> bytes:
        """Return bytes with their number before them."""
        return self.take(self.read_uint(size_of_size))

    def read_string_map(self) -> dict[str, str]:
        """Return a map of texts."""
        inner, pairs = FieldCursor(self.read_bytes(4)), {}
        while inner.position < len(inner.data):
            key = inner.read_string()
            pairs[key] = inner.read_string()
        return pairs

    def take(self, size: int) -> bytes:
        """Return the next bytes."""
        end = self.position + size
        if end > len(self.data):
            raise DamageError("a record is shorter than its values")
        value, self.position = self.data[self.position : end], end
        return value


def iterate_records(data: bytes) -> Iterator[tuple[int, FieldCursor]]:
    """Yield the kind and the values of each record."""
    offset = 0
    while offset < len(data):
        if offset + RECORD.size > len(data):
            raise DamageError("it is cut off")
        kind, size = RECORD.unpack_from(data, offset)
        offset += RECORD.size
        if offset + size > len(data):
            raise DamageError("a record is longer than what it is in")
        yield kind, FieldCursor(data[offset : offset + size])
        offset += size


def decode_messages(chunk: bytes, channels: Channels) -> list[Message]:
    """Return the messages of an unpacked chunk in the order of the file, by the time of logging.

    A channel that is None is left out. Raise DamageError, struct.error, or KeyError for a channel
    that is not known.
    """
    messages: list[Message] = []
    offset, end, header_size = 0, len(chunk), _MESSAGE.size
    unpack = _MESSAGE.unpack_from
    while offset + header_size <= end:
        kind, size, channel, _, time, _ = unpack(chunk, offset)
        data_at, offset = offset + header_size, offset + RECORD.size + size
        if offset > end or (kind == MESSAGE and size < _MESSAGE_HEADER_SIZE):
            raise DamageError("a record is longer than its chunk, or too short")
        if kind == MESSAGE:
            connection = channels[channel]
            if connection is not None:
                messages.append((time, connection, chunk[data_at:offset]))
                if len(messages) > MAX_CHUNK_MESSAGES:
                    raise DamageError(f"more than {MAX_CHUNK_MESSAGES} messages in a chunk")
    return messages


def decode_message(fields: FieldCursor, channels: Channels) -> Message | None:
    """Return the message in a record, None if its channel is left out."""
    connection = channels[fields.read_uint(2)]
    fields.take(4)
    time = fields.read_uint(8)
    fields.take(8)
    return None if connection is None else (time, connection, fields.data[fields.position :])


MAGIC = b"\x89MCAP0\r\n"
RECOVER_HELP = "`mcap recover FILE -o OUT` saves what is left"
_FOOTER_SIZE = RECORD.size + 20 + len(MAGIC)
ROS_ENCODINGS: Mapping[str, Encoding] = {"ros1": "ros1", "cdr": "cdr"}
INCIDENT_ENCODINGS: Mapping[str, Encoding] = {**ROS_ENCODINGS, "json": "json"}
_DEFINITION_FORMATS = frozenset({"ros1msg", "ros2msg", "ros2idl"})
_TRUE = frozenset({"1", "true"})


class Chunk(NamedTuple):
    """A chunk: its first time (ns), where its record is, and its size unpacked."""

    start: int
    offset: int
    uncompressed_size: int


@dataclass(slots=True)
class _Schema:
    name: str
    format: str
    definition: str


@dataclass(frozen=True, slots=True)
class Summary:
    """Channels by number (None for one that is left out), and where chunks and metadata are."""

    channels: Channels = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)
    chunks: dict[int, Chunk] = field(default_factory=dict)
    schemas: dict[int, _Schema] = field(default_factory=dict)
    metadata: dict[str, int] = field(default_factory=dict)


def read_summary(
    stream: BufferedReader, path: Path, encodings: Mapping[str, Encoding] = ROS_ENCODINGS
) -> Summary:
    """Return a file's summary, with the channels that have one of the `encodings`.

    Raise InputError, DamageError, struct.error or ValueError.
    """
    if stream.read(len(MAGIC)) != MAGIC:
        raise InputError("no MCAP", path=str(path), help="is it the right file?")
    size = stream.seek(0, 2)
    footer_at = size - _FOOTER_SIZE
    stream.seek(max(footer_at, 0))
    end = stream.read()
    if footer_at < len(MAGIC) or not end.endswith(MAGIC) or end[0] != FOOTER:
        raise InputError("the recording was cut off", path=str(path), help=RECOVER_HELP)
    start = FieldCursor(end, RECORD.size).read_uint(8)
    if not start:
        raise InputError("it has no summary", path=str(path), help=RECOVER_HELP)
    if not len(MAGIC) <= start <= footer_at or footer_at - start > MAX_INDEX_BYTES:
        raise DamageError("its summary is not where it should be, or too large")
    stream.seek(start)
    return _parse_summary(stream.read(footer_at - start), encodings)


def _parse_summary(data: bytes, encodings: Mapping[str, Encoding]) -> Summary:
    summary = Summary()
    for kind, fields in iterate_records(data):
        if kind == SCHEMA:
            id = fields.read_uint(2)
            summary.schemas[id] = _parse_schema(fields)
        elif kind == CHANNEL:
            _add_channel(summary, fields, encodings)
        elif kind == CHUNK_INDEX:
            chunk = _parse_chunk(fields)
            summary.chunks[chunk.offset] = chunk
        elif kind == METADATA_INDEX:
            offset, _ = fields.read_uint(8), fields.read_uint(8)
            summary.metadata[fields.read_string()] = offset
    if summary.chunks and not summary.channels:
        raise DamageError("its summary names no channels")
    return summary


def _parse_schema(fields: FieldCursor) -> _Schema:
    """Return a schema; a definition's comments may be in any encoding."""
    name, format = fields.read_string(), fields.read_string()
    known = format in _DEFINITION_FORMATS
    return _Schema(name, format, fields.read_bytes(4).decode(errors="replace") if known else "")


def _add_channel(summary: Summary, fields: FieldCursor, encodings: Mapping[str, Encoding]) -> None:
    id, schema_id = fields.read_uint(2), fields.read_uint(2)
    topic, encoding, metadata = fields.read_string(), fields.read_string(), fields.read_string_map()
    schema = summary.schemas.get(schema_id, _Schema("", "", ""))
    summary.channels[id] = None
    if encoding in encodings:
        summary.channels[id] = BagConnection(
            topic=topic,
            type=schema.name,
            encoding=encodings[encoding],
            md5sum=metadata.get("md5sum", ""),
            definition=schema.definition,
            definition_format=schema.format,
            callerid=metadata.get("callerid", ""),
            latching=metadata.get("latching", "") in _TRUE,
            offered_qos=parse_offered_qos(metadata.get("offered_qos_profiles", "")),
        )
    else:
        summary.skipped[topic] = unknown_encoding(encoding)


def _parse_chunk(fields: FieldCursor) -> Chunk:
    start, _, offset, _ = (fields.read_uint(8) for _ in range(4))
    fields.read_bytes(4)
    fields.read_uint(8)
    fields.read_string()
    fields.read_uint(8)
    return Chunk(start, offset, fields.read_uint(8))
