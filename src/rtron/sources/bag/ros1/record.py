"""Records of a ROS 1 bag: headers of `name=value` fields (ROS wiki: Bags/Format/2.0)."""

from collections.abc import Mapping
from dataclasses import dataclass
from io import BufferedReader
from struct import Struct

from rtron.sources.bag.common.reader import MAX_HEADER_BYTES, MAX_INDEX_BYTES, DamageError

MESSAGE, BAG_HEADER, CHUNK, CHUNK_INFO, CONNECTION = 2, 3, 5, 6, 7
SECOND = 10**9
_U32 = Struct("<I")
_TIME = Struct("<II")

Fields = Mapping[bytes, bytes]


@dataclass(slots=True)
class RecordReader:
    """Records read one after the other, no more of them than an index may have."""

    stream: BufferedReader
    remaining: int = MAX_INDEX_BYTES

    def at_end(self) -> bool:
        """Tell whether there is no further record."""
        return not self.stream.peek(1)

    def read_header(self) -> Fields:
        """Return the next record's header."""
        return parse_fields(self._read_sized(MAX_HEADER_BYTES))

    def read_data(self, limit: int) -> bytes:
        """Return what follows the header, at most `limit` bytes."""
        return self._read_sized(limit)

    def _read_sized(self, limit: int) -> bytes:
        (size,) = _U32.unpack(self._read(4))
        if size > limit:
            raise DamageError(f"a record of {size} bytes where at most {limit} are allowed")
        return self._read(size)

    def _read(self, size: int) -> bytes:
        self.remaining -= size
        if self.remaining < 0:
            raise DamageError(f"an index of more than {MAX_INDEX_BYTES} bytes")
        data = self.stream.read(size)
        if len(data) < size:
            raise DamageError("it is cut off")
        return data


def parse_fields(header: bytes) -> Fields:
    """Return a header's fields."""
    fields, offset = {}, 0
    while offset < len(header):
        (size,) = _U32.unpack_from(header, offset)
        name, equals, value = header[offset + 4 : offset + 4 + size].partition(b"=")
        offset += 4 + size
        if not equals or offset > len(header):
            raise DamageError("a header is no list of fields")
        fields[name] = value
    return fields


def opcode(fields: Fields) -> int:
    """Return what kind of record a header begins."""
    return uint_field(fields, b"op")


def uint_field(fields: Fields, name: bytes) -> int:
    """Return a field that is a number of any size."""
    return int.from_bytes(_value(fields, name), "little")


def text_field(fields: Fields, name: bytes) -> str:
    """Return a field that is a text."""
    return _value(fields, name).decode()


def time_field(fields: Fields, name: bytes) -> int:
    """Return a field that is a time, in ns."""
    seconds, nanoseconds = _TIME.unpack(_value(fields, name))
    return int(seconds * SECOND + nanoseconds)


def _value(fields: Fields, name: bytes) -> bytes:
    try:
        return fields[name]
    except KeyError:
        raise DamageError(f"a header has no field {name.decode()!r}") from None
