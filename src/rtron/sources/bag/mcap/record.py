"""Records of an MCAP file and the values in them (mcap.dev: MCAP specification, Records)."""

from collections.abc import Iterator
from dataclasses import dataclass
from struct import Struct
from typing import TypeAlias

from rtron.sources.bag.common.limits import MAX_CHUNK_MESSAGES, DamageError
from rtron.sources.bag.common.reader import BagConnection, Message

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
