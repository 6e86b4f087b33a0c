"""Records of a ROS 1 bag: headers of `name=value` fields (ROS wiki: Bags/Format/2.0)."""

from collections.abc import Mapping
from dataclasses import dataclass
from io import BufferedReader
from struct import Struct

from rtron.sources.bag.common.limits import MAX_HEADER, MAX_INDEX, DamageError

MESSAGE, BAG, CHUNK, CHUNK_INFO, CONNECTION = 2, 3, 5, 6, 7
SECOND = 10**9
_U32 = Struct("<I")
_TIME = Struct("<II")

Fields = Mapping[bytes, bytes]


@dataclass(slots=True)
class RecordFile:
    """Records read one after the other, no more of them than an index may have."""

    stream: BufferedReader
    left: int = MAX_INDEX

    def at_end(self) -> bool:
        """Tell whether there is no further record."""
        return not self.stream.peek(1)

    def header(self) -> Fields:
        """Return the next record's header."""
        return fields_of(self._sized(MAX_HEADER))

    def data(self, limit: int) -> bytes:
        """Return what follows the header, at most `limit` bytes."""
        return self._sized(limit)

    def _sized(self, limit: int) -> bytes:
        (size,) = _U32.unpack(self._take(4))
        if size > limit:
            raise DamageError(f"a record of {size} bytes where at most {limit} are allowed")
        return self._take(size)

    def _take(self, size: int) -> bytes:
        self.left -= size
        if self.left < 0:
            raise DamageError(f"an index of more than {MAX_INDEX} bytes")
        data = self.stream.read(size)
        if len(data) < size:
            raise DamageError("it is cut off")
        return data


def fields_of(header: bytes) -> Fields:
    """Return a header's fields."""
    found, at = {}, 0
    while at < len(header):
        (size,) = _U32.unpack_from(header, at)
        name, equals, value = header[at + 4 : at + 4 + size].partition(b"=")
        at += 4 + size
        if not equals or at > len(header):
            raise DamageError("a header is no list of fields")
        found[name] = value
    return found


def operation(fields: Fields) -> int:
    """Return what kind of record a header begins."""
    return number(fields, b"op")


def number(fields: Fields, name: bytes) -> int:
    """Return a field that is a number of any size."""
    return int.from_bytes(_value(fields, name), "little")


def text(fields: Fields, name: bytes) -> str:
    """Return a field that is a text."""
    return _value(fields, name).decode()


def time(fields: Fields, name: bytes) -> int:
    """Return a field that is a time, in ns."""
    seconds, nanoseconds = _TIME.unpack(_value(fields, name))
    return int(seconds * SECOND + nanoseconds)


def _value(fields: Fields, name: bytes) -> bytes:
    try:
        return fields[name]
    except KeyError:
        raise DamageError(f"a header has no field {name.decode()!r}") from None
