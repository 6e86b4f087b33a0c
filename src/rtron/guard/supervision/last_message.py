"""What the guard leaves to the supervisor about one stream: its type, and its last message."""

import json
import struct
from dataclasses import asdict, dataclass

from rtron.guard.transport.common.protocol import TypeInfo

_TIMES = struct.Struct("=QQ")
_MAX_MESSAGE_BYTES = 1 << 11
_MAX_DEFINITION = 1 << 15


@dataclass(frozen=True, slots=True)
class LastMessage:
    """The last message that went out: when, and until when it is in force (ns).

    Before the first message `sent_at` is 0; one that is too long to be a velocity is left out.
    """

    sent_at: int
    valid_until: int
    message: bytes

    def encode(self) -> bytes:
        """Return it as bytes."""
        message = self.message if len(self.message) <= _MAX_MESSAGE_BYTES else b""
        return _TIMES.pack(self.sent_at, self.valid_until) + message


def decode_last_message(data: bytes) -> LastMessage:
    """Return what `Said.bytes` gave, or nothing said if that is nothing."""
    sent_at, valid_until = _TIMES.unpack_from(data) if data else (0, 0)
    return LastMessage(sent_at, valid_until, data[_TIMES.size :])


def encode_type_info(info: TypeInfo) -> bytes:
    """Return a type as bytes; a definition that is too long is left out."""
    definition = info.definition if len(info.definition) <= _MAX_DEFINITION else ""
    return json.dumps(asdict(info) | {"definition": definition}).encode()


def decode_type_info(data: bytes) -> TypeInfo | None:
    """Return the type that was written; None if none was, or it was too long."""
    return TypeInfo(**json.loads(data)) if data else None
