"""Records of an MCAP file and the values in them (mcap.dev: MCAP specification, Records)."""

from collections.abc import Iterator
from dataclasses import dataclass
from struct import Struct
from typing import TypeAlias

from rtron.sources.bag.common.limits import MAX_CHUNK_MESSAGES, DamageError
from rtron.sources.bag.common.reader import BagConnection, Message

FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX, DATA_END = 2, 3, 4, 5, 6, 8, 15
RECORD = Struct("<BQ")
_MESSAGE = Struct("<BQHIQQ")
_HEAD = _MESSAGE.size - RECORD.size
_NUMBERS = {size: Struct(code) for size, code in ((2, "<H"), (4, "<I"), (8, "<Q"))}


Channels: TypeAlias = dict[int, BagConnection | None]


@dataclass(slots=True)
class Values:
    """A record's values, read one after the other; raise DamageError past its end."""

    data: bytes
    at: int = 0

    def number(self, size: int) -> int:
        """Return a number of 2, 4 or 8 bytes."""
        (value,) = _NUMBERS[size].unpack(self.take(size))
        return int(value)

    def text(self) -> str:
        """Return a text."""
        return self.block(4).decode()

    def block(self, size_of_size: int) -> bytes:
        """Return bytes with their number before them."""
        return self.take(self.number(size_of_size))

    def pairs(self) -> dict[str, str]:
        """Return a map of texts."""
        inner, found = Values(self.block(4)), {}
        while inner.at < len(inner.data):
            key = inner.text()
            found[key] = inner.text()
        return found

    def take(self, size: int) -> bytes:
        """Return the next bytes."""
        end = self.at + size
        if end > len(self.data):
            raise DamageError("a record is shorter than its values")
        value, self.at = self.data[self.at : end], end
        return value


def records_of(data: bytes) -> Iterator[tuple[int, Values]]:
    """Yield the kind and the values of each record."""
    at = 0
    while at < len(data):
        if at + RECORD.size > len(data):
            raise DamageError("it is cut off")
        kind, size = RECORD.unpack_from(data, at)
        at += RECORD.size
        if at + size > len(data):
            raise DamageError("a record is longer than what it is in")
        yield kind, Values(data[at : at + size])
        at += size


def messages_of(chunk: bytes, channels: Channels) -> list[Message]:
    """Return the messages of an unpacked chunk in the order of the file, by the time of logging.

    A channel that is None is left out. Raise DamageError, struct.error, or KeyError for a channel
    that is not known.
    """
    found: list[Message] = []
    at, end, head = 0, len(chunk), _MESSAGE.size
    unpack = _MESSAGE.unpack_from
    while at + head <= end:
        kind, size, channel, _, time, _ = unpack(chunk, at)
        data_at, at = at + head, at + RECORD.size + size
        if at > end or (kind == MESSAGE and size < _HEAD):
            raise DamageError("a record is longer than its chunk, or too short")
        if kind == MESSAGE:
            connection = channels[channel]
            if connection is not None:
                found.append((time, connection, chunk[data_at:at]))
                if len(found) > MAX_CHUNK_MESSAGES:
                    raise DamageError(f"more than {MAX_CHUNK_MESSAGES} messages in a chunk")
    return found


def message_of(values: Values, channels: Channels) -> Message | None:
    """Return the message in a record, None if its channel is left out."""
    connection = channels[values.number(2)]
    values.take(4)
    time = values.number(8)
    values.take(8)
    return None if connection is None else (time, connection, values.data[values.at :])
