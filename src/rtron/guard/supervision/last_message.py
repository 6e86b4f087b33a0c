"""What the guard leaves to the supervisor about one stream: its type, and its last message."""

import json
import struct
from dataclasses import asdict, dataclass

from rtron.guard.transport.common.protocol import TypeInfo

_TIMES = struct.Struct("=QQ")
_LONGEST = 1 << 11
_LONGEST_DEFINITION = 1 << 15


@dataclass(frozen=True, slots=True)
class Said:
    """The last message that went out: when, and until when it is in force (ns).

    Before the first message `at` is 0; one that is too long to be a velocity is left out.
    """

    at: int
    until: int
    message: bytes

    def bytes(self) -> bytes:
        """Return it as bytes."""
        message = self.message if len(self.message) <= _LONGEST else b""
        return _TIMES.pack(self.at, self.until) + message


def said_of(data: bytes) -> Said:
    """Return what `Said.bytes` gave, or nothing said if that is nothing."""
    at, until = _TIMES.unpack_from(data) if data else (0, 0)
    return Said(at, until, data[_TIMES.size :])


def info_bytes(info: TypeInfo) -> bytes:
    """Return a type as bytes; a definition that is too long is left out."""
    definition = info.definition if len(info.definition) <= _LONGEST_DEFINITION else ""
    return json.dumps(asdict(info) | {"definition": definition}).encode()


def info_of(data: bytes) -> TypeInfo | None:
    """Return the type that was written; None if none was, or it was too long."""
    return TypeInfo(**json.loads(data)) if data else None
