"""The time stamp in a message's header, without reading anything else of it."""

import struct
from collections.abc import Callable

from rtron.errors import WireError
from rtron.messages.common.definition import HEADER, Definition
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.vocabulary import SECOND


def stamp_reader(definition: Definition, encoding: Encoding) -> Callable[[bytes], int] | None:
    """Return what reads the header's stamp (ns); None if a message does not begin with a header.

    ROS 1 has a sequence number before the stamp, ROS 2 has none. What it returns raises WireError
    for a message that is too short for a stamp.
    """
    first = definition.fields[0] if definition.fields else None
    if first is None or first.array or first.type != HEADER:
        return None
    types = [None if each.array else each.type for each in definition.nested[HEADER].fields]
    if types[:1] != ["time"] and types[:2] != ["uint32", "time"]:
        return None
    at = PREFIX + (4 if types[0] == "uint32" else 0)
    return _reader(encoding, struct.Struct("<II" if encoding is Encoding.ROS1 else "<iI"), at)


def _reader(encoding: Encoding, stamp: struct.Struct, at: int) -> Callable[[bytes], int]:
    end = at + stamp.size

    def read(message: bytes) -> int:
        encoding.check_prefix(message)
        if len(message) < end:
            raise WireError(f"a message of {len(message)} bytes ends before its stamp does")
        seconds, nanoseconds = stamp.unpack_from(message, at)
        stamped: int = seconds * SECOND + nanoseconds
        return stamped

    return read
