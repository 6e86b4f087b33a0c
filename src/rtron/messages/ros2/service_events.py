"""What ROS 2's service introspection publishes of requests and answers (REP 2012), as CDR.

An event holds who asked, the number of the request, and the request or the answer; or neither,
where only metadata are published. Readers raise WireError for what is no such event.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.messages.common.layout import alignment
from rtron.vocabulary import SECOND

_LITTLE = b"\x00\x01\x00\x00"
_INFO = struct.Struct("<4xB3xiI16s4xqI")
_ID = struct.Struct("<16s")
_CANCEL = struct.Struct("<16siI")
_ANSWER = struct.Struct("<?3xiI")
_COUNT = struct.Struct("<I")
_REQUEST_KINDS = (0, 1)
"""The kinds of an event of a request: as its client sends it, and as its server gets it."""


@dataclass(frozen=True, slots=True)
class ServiceEvent:
    """One request or response, of the client `client_gid` and with its number `sequence_number`.

    `content_offset` is where its content begins in the message, 0 where only metadata is published.
    """

    is_request: bool
    client_gid: bytes
    sequence_number: int
    content_offset: int


def read_event(message: bytes) -> ServiceEvent:
    """Return what an event says of itself (service_msgs/ServiceEventInfo)."""
    Encoding.CDR.check_prefix(message)
    kind, _, _, client_gid, number, has_request = _unpacked(_INFO, message, 0)
    is_request = kind in _REQUEST_KINDS
    at = _INFO.size
    if is_request:
        return ServiceEvent(is_request, client_gid, number, at if has_request else 0)
    (has_response,) = _unpacked(_COUNT, message, at) if not has_request else (0,)
    return ServiceEvent(is_request, client_gid, number, at + _COUNT.size if has_response else 0)


def read_goal(message: bytes, at: int) -> tuple[bytes, int]:
    """Return the id of the goal that a request sends, and where the goal itself begins."""
    (id,) = _unpacked(_ID, message, at)
    return id, at + _ID.size


def read_cancel(message: bytes, at: int) -> tuple[bytes, int]:
    """Return the id and the stamp (ns) that a request to cancel names."""
    id, seconds, nanoseconds = _unpacked(_CANCEL, message, at)
    return id, seconds * SECOND + nanoseconds


def read_answer(message: bytes, at: int) -> int | None:
    """Return since when (ns) a goal is accepted, None if it was rejected."""
    accepted, seconds, nanoseconds = _unpacked(_ANSWER, message, at)
    return seconds * SECOND + nanoseconds if accepted else None


def message_extractor(definition: Definition) -> Callable[[bytes, int], bytes]:
    """Return what makes a message of its own of one that lies in another, from an offset on.

    What is aligned there need not be, where it begins a message.
    """

    def move(data: bytes, at: int) -> bytes:
        copy = _Realigner(data, at)
        copy.fields(definition)
        return bytes(copy.message)

    return move


class _Realigner:
    """A message in the making, and where it is read."""

    def __init__(self, data: bytes, at: int) -> None:
        self._data = data
        self._at = at
        self.message = bytearray(_LITTLE)

    def fields(self, definition: Definition) -> None:
        for field in definition.fields:
            self._field(field, definition)
        if not definition.fields:
            self._block(1, 1)

    def _field(self, field: Field, definition: Definition) -> None:
        count = 1
        if field.array:
            count = field.length or self._count()
        if field.type in SIZES:
            if count:
                self._block(count * SIZES[field.type], alignment(field.type, Encoding.CDR))
            return
        for _ in range(count):
            if field.type == "string":
                self._block(self._count(), 1)
            else:
                self.fields(definition.nested[field.type])

    def _count(self) -> int:
        count: int = _COUNT.unpack(self._block(_COUNT.size, _COUNT.size))[0]
        return count

    def _block(self, size: int, align: int) -> bytes:
        self._at += (PREFIX - self._at) % align
        self.message += bytes((PREFIX - len(self.message)) % align)
        block = self._data[self._at : self._at + size]
        if len(block) < size:
            raise WireError(f"a message of {len(self._data)} bytes ends too early")
        self._at += size
        self.message += block
        return block


def _unpacked(form: struct.Struct, message: bytes, at: int) -> tuple[Any, ...]:
    try:
        return form.unpack_from(message, at)
    except struct.error:
        raise WireError(f"a message of {len(message)} bytes ends too early") from None
