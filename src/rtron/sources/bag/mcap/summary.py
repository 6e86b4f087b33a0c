"""The summary of an MCAP file: its channels, and where its chunks are (mcap.dev: Specification)."""

from dataclasses import dataclass, field
from io import BufferedReader
from pathlib import Path
from typing import NamedTuple

from rtron.errors import InputError
from rtron.sources.bag.common.limits import MAX_INDEX, DamageError
from rtron.sources.bag.common.reader import BagConnection, Encoding, not_of_ros
from rtron.sources.bag.mcap.record import (
    CHANNEL,
    CHUNK_INDEX,
    FOOTER,
    RECORD,
    SCHEMA,
    Channels,
    Values,
    records_of,
)
from rtron.sources.bag.ros2.offered_qos import offered_qos

MAGIC = b"\x89MCAP0\r\n"
RECOVER = "`mcap recover FILE -o OUT` saves what is left"
_END = RECORD.size + 20 + len(MAGIC)
_ENCODINGS: dict[str, Encoding] = {"ros1": "ros1", "cdr": "cdr"}
_FORMATS = frozenset({"ros1msg", "ros2msg", "ros2idl"})
_TRUE = frozenset({"1", "true"})


class Chunk(NamedTuple):
    """A chunk: its first time (ns), where its record is, and its size unpacked."""

    start: int
    at: int
    unpacked: int


@dataclass(slots=True)
class _Schema:
    name: str
    format: str
    definition: str


@dataclass(frozen=True, slots=True)
class Summary:
    """Channels by number (None for one that is not of ROS), and where the chunks are."""

    channels: Channels = field(default_factory=dict)
    left_out: dict[str, str] = field(default_factory=dict)
    chunks: dict[int, Chunk] = field(default_factory=dict)
    schemas: dict[int, _Schema] = field(default_factory=dict)


def read_summary(stream: BufferedReader, path: Path) -> Summary:
    """Return a file's summary; raise InputError, DamageError, struct.error or ValueError."""
    if stream.read(len(MAGIC)) != MAGIC:
        raise InputError("no MCAP", path=str(path), help="is it the right file?")
    size = stream.seek(0, 2)
    footer_at = size - _END
    stream.seek(max(footer_at, 0))
    end = stream.read()
    if footer_at < len(MAGIC) or not end.endswith(MAGIC) or end[0] != FOOTER:
        raise InputError("the recording was cut off", path=str(path), help=RECOVER)
    start = Values(end, RECORD.size).number(8)
    if not start:
        raise InputError("it has no summary", path=str(path), help=RECOVER)
    if not len(MAGIC) <= start <= footer_at or footer_at - start > MAX_INDEX:
        raise DamageError("its summary is not where it should be, or too large")
    stream.seek(start)
    return _summary(stream.read(footer_at - start))


def _summary(data: bytes) -> Summary:
    summary = Summary()
    for kind, values in records_of(data):
        if kind == SCHEMA:
            id = values.number(2)
            summary.schemas[id] = _schema(values)
        elif kind == CHANNEL:
            _add_channel(summary, values)
        elif kind == CHUNK_INDEX:
            chunk = _chunk(values)
            summary.chunks[chunk.at] = chunk
    if summary.chunks and not summary.channels:
        raise DamageError("its summary names no channels")
    return summary


def _schema(values: Values) -> _Schema:
    """Return a schema; a definition's comments may be in any encoding."""
    name, format = values.text(), values.text()
    known = format in _FORMATS
    return _Schema(name, format, values.block(4).decode(errors="replace") if known else "")


def _add_channel(summary: Summary, values: Values) -> None:
    id, schema_id = values.number(2), values.number(2)
    topic, encoding, metadata = values.text(), values.text(), values.pairs()
    schema = summary.schemas.get(schema_id, _Schema("", "", ""))
    summary.channels[id] = None
    if encoding in _ENCODINGS:
        summary.channels[id] = BagConnection(
            topic=topic,
            type=schema.name,
            encoding=_ENCODINGS[encoding],
            md5sum=metadata.get("md5sum", ""),
            definition=schema.definition,
            definition_format=schema.format,
            callerid=metadata.get("callerid", ""),
            latching=metadata.get("latching", "") in _TRUE,
            offered_qos=offered_qos(metadata.get("offered_qos_profiles", "")),
        )
    else:
        summary.left_out[topic] = not_of_ros(encoding)


def _chunk(values: Values) -> Chunk:
    start, _, at, _ = (values.number(8) for _ in range(4))
    values.block(4)
    values.number(8)
    values.text()
    values.number(8)
    return Chunk(start, at, values.number(8))
