"""The summary of an MCAP file: its channels, and where its chunks are (mcap.dev: Specification)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BufferedReader
from pathlib import Path
from typing import NamedTuple

from rtron.errors import InputError
from rtron.sources.bag.common.limits import MAX_INDEX_BYTES, DamageError
from rtron.sources.bag.common.reader import BagConnection, Encoding, unknown_encoding
from rtron.sources.bag.mcap.record import (
    CHANNEL,
    CHUNK_INDEX,
    FOOTER,
    METADATA_INDEX,
    RECORD,
    SCHEMA,
    Channels,
    FieldCursor,
    iterate_records,
)
from rtron.sources.bag.ros2.offered_qos import parse_offered_qos

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
