"""An MCAP file, one chunk after the other (mcap.dev: MCAP specification)."""

import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from io import BufferedReader
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bag.common.compression import decompress
from rtron.sources.bag.common.reader import (
    MAX_CHUNK_BYTES,
    BagReader,
    DamageError,
    DecompressionBudget,
    Encoding,
    Message,
    damage_error,
    merge_by_time,
    open_bag_file,
    sort_by_time,
)
from rtron.sources.bag.mcap.record import (
    CHUNK,
    DATA_END,
    MAGIC,
    MESSAGE,
    METADATA,
    RECORD,
    RECOVER_HELP,
    Channels,
    Chunk,
    FieldCursor,
    Summary,
    decode_message,
    decode_messages,
    read_summary,
)

_NAMES = {CHUNK: "chunk", METADATA: "metadata"}
_MOST_METADATA = 64
_LONGEST_METADATA = 1 << 23


def open_mcap(path: Path) -> BagReader:
    """Return an MCAP file's connections and the way to its messages.

    A file of profile `ros1` names the publishers, one of `ros2` does not. Raise InputError if it
    is no MCAP, has no summary, or is damaged.
    """
    with open_bag_file(path) as stream, _damage_as_input_error(path):
        summary = read_summary(stream, path)
    return _bag_reader(path, summary)


def open_mcap_with_metadata(
    path: Path, encodings: Mapping[str, Encoding]
) -> tuple[BagReader, dict[str, dict[str, str]]]:
    """Return an MCAP file's channels of these encodings, and its metadata by name.

    Raise InputError as `open_mcap` does, and for metadata that is too long.
    """
    with open_bag_file(path) as stream, _damage_as_input_error(path):
        summary = read_summary(stream, path, encodings)
        if len(summary.metadata) > _MOST_METADATA:
            raise DamageError(f"{len(summary.metadata)} records of metadata")
        metadata = dict(_read_metadata(stream, at) for at in summary.metadata.values())
    return _bag_reader(path, summary), metadata


def _bag_reader(path: Path, summary: Summary) -> BagReader:
    return BagReader(
        path=path,
        connections=tuple(filter(None, summary.channels.values())),
        messages=partial(_messages, path, summary),
        skipped=tuple(summary.skipped.items()),
    )


@contextmanager
def _damage_as_input_error(path: Path) -> Iterator[None]:
    """Turn what a damaged record causes into an InputError (UnicodeDecodeError is a ValueError)."""
    try:
        yield
    except KeyError as error:
        raise damage_error(path, f"a message of no channel ({error})", RECOVER_HELP) from None
    except (ValueError, struct.error, OSError) as error:
        raise damage_error(path, str(error), RECOVER_HELP) from None


def _messages(path: Path, summary: Summary) -> Iterator[Message]:
    with open_bag_file(path) as stream:
        if not summary.chunks:
            yield from _messages_without_chunks(stream, path, summary.channels)
            return
        budget = DecompressionBudget.for_file(path, stream.seek(0, 2))
        chunks = sorted(summary.chunks.values())
        batches = (_chunk_messages(stream, chunk, summary, budget) for chunk in chunks)
        yield from merge_by_time([chunk.start for chunk in chunks], batches, path)


def _chunk_messages(
    stream: BufferedReader, chunk: Chunk, summary: Summary, budget: DecompressionBudget
) -> list[Message]:
    with _damage_as_input_error(budget.path):
        budget.spend(chunk.uncompressed_size)
        values = _read_record_at(stream, chunk.offset, CHUNK)
        values.take(16)
        if values.read_uint(8) != chunk.uncompressed_size:
            raise DamageError("its index and a chunk do not agree")
        values.take(4)
        compression, data = values.read_string(), values.read_bytes(8)
        data_of_chunk = decompress(compression, data, chunk.uncompressed_size)
        return sort_by_time(decode_messages(data_of_chunk, summary.channels))


def _read_metadata(stream: BufferedReader, offset: int) -> tuple[str, dict[str, str]]:
    fields = _read_record_at(stream, offset, METADATA, _LONGEST_METADATA)
    return fields.read_string(), fields.read_string_map()


def _read_record_at(
    stream: BufferedReader, offset: int, expected: int, longest: int = MAX_CHUNK_BYTES
) -> FieldCursor:
    """Return the record of a kind at a place that an index names."""
    if offset > stream.seek(0, 2):
        raise DamageError("it is cut off")
    stream.seek(offset)
    kind, values = _read_record(stream, longest)
    if kind != expected:
        raise DamageError(f"its index points to no {_NAMES[expected]}")
    return values


def _messages_without_chunks(
    stream: BufferedReader, path: Path, channels: Channels
) -> Iterator[Message]:
    """Yield messages that stand in no chunk, as a recorder set to write fast leaves them."""
    stream.seek(len(MAGIC))
    last_time = 0
    while message := _next_message(stream, path, channels):
        if message[0] < last_time:
            help = "`mcap sort FILE -o OUT` brings its messages in the order of time"
            raise InputError("its messages are out of order", path=str(path), help=help)
        last_time = message[0]
        yield message


def _next_message(stream: BufferedReader, path: Path, channels: Channels) -> Message | None:
    """Return the next message that is of ROS, None at the end of the data."""
    with _damage_as_input_error(path):
        while True:
            kind, values = _read_record(stream)
            if kind == DATA_END:
                return None
            if kind == CHUNK:
                raise DamageError("its summary does not say where its chunks are")
            message = decode_message(values, channels) if kind == MESSAGE else None
            if message:
                return message


def _read_record(stream: BufferedReader, longest: int = MAX_CHUNK_BYTES) -> tuple[int, FieldCursor]:
    kind, size = RECORD.unpack(stream.read(RECORD.size))
    if size > longest:
        raise DamageError(f"a record of {size} bytes")
    data = stream.read(size)
    if len(data) < size:
        raise DamageError("it is cut off")
    return kind, FieldCursor(data)
