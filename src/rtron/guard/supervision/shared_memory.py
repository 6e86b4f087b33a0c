"""What the guard and its supervisor share: a few pages of memory that outlive either of them.

Each number is one aligned word; documents are double buffers.
"""

import json
import mmap
import os
import struct
from dataclasses import asdict, dataclass
from enum import IntEnum
from zlib import crc32

from rtron.guard.core.handover_state import MOST_BYTES
from rtron.guard.system.sealed_memory import create_sealed_memory
from rtron.guard.transport.common.protocol import TypeInfo

_HEAD = struct.Struct("=QII")
_HEAD_SIZE = _HEAD.size
_pack_head = _HEAD.pack_into


class DoubleBuffer:
    """A document of at most `capacity` bytes; one process writes it."""

    def __init__(self, memory: mmap.mmap, start: int, capacity: int) -> None:
        self._memory = memory
        self._capacity = capacity
        self._halves = (start, start + _HEAD_SIZE + capacity)
        self._write_count = self.write_count()

    @staticmethod
    def size(capacity: int) -> int:
        """Return how much memory a cell needs."""
        return 2 * (_HEAD_SIZE + capacity)

    def write(self, document: bytes) -> bool:
        """Write a document; False, and nothing is there any more, if it is too long."""
        length = len(document)
        if length > self._capacity:
            self.write(b"")
            return False
        self._write_count = count = self._write_count + 1
        at = self._halves[count & 1]
        self._memory[at + _HEAD_SIZE : at + _HEAD_SIZE + length] = document
        _pack_head(self._memory, at, count, length, crc32(document))
        return True

    def read(self) -> tuple[int, bytes]:
        """Return how often was written, and the newest document that is whole; (0, empty) if none.

        While this is read the writer may write twice; then the count is that of an older one.
        """
        return max(map(self._read_half, self._halves))

    def write_count(self) -> int:
        """Return how often was written, as far as the heads say."""
        return self.head()[0]

    def head(self) -> tuple[int, int, int]:
        """Return how often was written, and the newest document's length and CRC: it tells changes.

        Two writers of which the second has not seen what the first wrote give one count twice.
        """
        heads: list[tuple[int, int, int]] = [
            _HEAD.unpack_from(self._memory, at) for at in self._halves
        ]
        return max(heads)

    def _read_half(self, at: int) -> tuple[int, bytes]:
        count, length, crc = _HEAD.unpack_from(self._memory, at)
        body = self._memory[at + _HEAD_SIZE : at + _HEAD_SIZE + min(length, self._capacity)]
        return (count, body) if crc32(body) == crc else (0, b"")


_WORD = 8
_FAILURE_REPORT_BYTES = 1 << 12
_PARTICIPANT_BYTES = 16
_TYPE_INFO_BYTES = 1 << 16
_LAST_MESSAGE_BYTES = 1 << 12


BEGIN = b"B"
"""What a supervisor sends to a guard that it has started, when it is to guard."""


class StatusWord(IntEnum):
    """The words at the beginning, each written by one side only."""

    GUARD_BEAT = 0
    """When the guard's loop last came round (ns); 0 until it runs. The guard's."""
    SERVING = 1
    """When the guard's topics were opened (ns), 0 before. The guard's."""
    LEAVING = 2
    """Whether the guard ends in order. The guard's."""
    SUPERVISOR_BEAT = 3
    """When the supervisor's loop last came round (ns). The supervisor's."""
    STOPPED = 4
    """When the supervisor last stopped the robot (ns), 0 if never. The supervisor's."""
    READY = 5
    """When the guard had loaded what it needs to begin (ns), 0 before. The guard's."""
    UNDELIVERED = 6
    """Whether the supervisor's pings do not come back through the guard. The supervisor's."""
    UNWATCHED = 7
    """Whether no ping has ever come back, long after the guard began. The supervisor's."""


class GuardMemory:
    """The shared memory of one guard with `streams` streams that it can stop.

    The guard writes `handover_state`, the supervisor `failure_report` and, once it is in the domain
    of ROS 2, `supervisor_participant`. `type_infos` has the message
    type of each stream, once the guard has learned it, and `last_messages` what it sent last.
    """

    def __init__(self, descriptor: int, streams: int) -> None:
        self.descriptor = descriptor
        self._memory = mmap.mmap(descriptor, _size(streams))
        self._words = memoryview(self._memory)[: len(StatusWord) * _WORD].cast("Q")
        self._end = mmap.PAGESIZE
        self.handover_state = self._add_buffer(MOST_BYTES)
        self.failure_report = self._add_buffer(_FAILURE_REPORT_BYTES)
        self.supervisor_participant = self._add_buffer(_PARTICIPANT_BYTES)
        self.type_infos = [self._add_buffer(_TYPE_INFO_BYTES) for _ in range(streams)]
        self.last_messages = [self._add_buffer(_LAST_MESSAGE_BYTES) for _ in range(streams)]

    @classmethod
    def create(cls, streams: int) -> "GuardMemory":
        """Return a page of its own, all zero."""
        descriptor = create_sealed_memory("rtron", _size(streams))
        try:
            return cls(descriptor, streams)
        except BaseException:
            os.close(descriptor)
            raise

    def __getitem__(self, field: StatusWord) -> int:
        """Return a word."""
        return self._words[field]

    def __setitem__(self, field: StatusWord, value: int) -> None:
        """Set a word, at once for the other side too."""
        self._words[field] = value

    def close(self) -> None:
        """Let go of the memory; the other side keeps it."""
        self._words.release()
        self._memory.close()
        os.close(self.descriptor)

    def _add_buffer(self, capacity: int) -> DoubleBuffer:
        at = self._end
        self._end += DoubleBuffer.size(capacity)
        return DoubleBuffer(self._memory, at, capacity)


def _size(streams: int) -> int:
    each = DoubleBuffer.size(_TYPE_INFO_BYTES) + DoubleBuffer.size(_LAST_MESSAGE_BYTES)
    return (
        mmap.PAGESIZE
        + DoubleBuffer.size(MOST_BYTES)
        + DoubleBuffer.size(_FAILURE_REPORT_BYTES)
        + DoubleBuffer.size(_PARTICIPANT_BYTES)
        + streams * each
    )


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


def encode_last_message(sent_at: int, valid_until: int, message: bytes) -> bytes:
    """Return the fields of a `LastMessage` as bytes."""
    return _TIMES.pack(sent_at, valid_until) + (
        message if len(message) <= _MAX_MESSAGE_BYTES else b""
    )


def decode_last_message(data: bytes) -> LastMessage:
    """Return what `encode_last_message` wrote; an empty one if none was written."""
    sent_at, valid_until = _TIMES.unpack_from(data) if data else (0, 0)
    return LastMessage(sent_at, valid_until, data[_TIMES.size :])


def encode_type_info(info: TypeInfo) -> bytes:
    """Return a type as bytes; a definition that is too long is left out."""
    definition = info.definition if len(info.definition) <= _MAX_DEFINITION else ""
    return json.dumps(asdict(info) | {"definition": definition}).encode()


def decode_type_info(data: bytes) -> TypeInfo | None:
    """Return the type that was written; None if none was, or it was too long."""
    return TypeInfo(**json.loads(data)) if data else None
