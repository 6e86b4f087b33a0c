"""What the guard and its supervisor share: a few pages of memory that outlive either of them.

Each number is one aligned word. Each document is written to the older of two halves, with a count
and a CRC: a writer that dies in the middle leaves the document before readable, whatever order the
other processor sees the bytes in.
"""

import mmap
import os
import struct
import zlib
from enum import IntEnum

from rtron.guard.core.handover_state import MOST_BYTES

_WORD = 8
_HEAD = struct.Struct("=QII")
_NEWS_BYTES = 1 << 12
_INFO_BYTES = 1 << 16
_SAID_BYTES = 1 << 12


class Field(IntEnum):
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
    OWNER = 5
    """The process that started the supervisor, roslaunch or a shell. The supervisor's."""


class Cell:
    """A document of at most `capacity` bytes; one process writes it."""

    def __init__(self, memory: mmap.mmap, start: int, capacity: int) -> None:
        self._memory = memory
        self._capacity = capacity
        self._halves = (start, start + _HEAD.size + capacity)
        self._newest = self.count()

    @staticmethod
    def size(capacity: int) -> int:
        """Return how much memory a cell needs."""
        return 2 * (_HEAD.size + capacity)

    def write(self, document: bytes) -> bool:
        """Write a document; False, and nothing is there any more, if it is too long."""
        fits = len(document) <= self._capacity
        body = document if fits else b""
        self._newest += 1
        at = self._halves[self._newest % 2] + _HEAD.size
        self._memory[at : at + len(body)] = body
        head = (self._newest, len(body), zlib.crc32(body))
        _HEAD.pack_into(self._memory, at - _HEAD.size, *head)
        return fits

    def read(self) -> tuple[int, bytes]:
        """Return how often was written, and the newest document that is whole; (0, empty) if none.

        While this is read the writer may write twice; then the count is that of an older one.
        """
        return max(map(self._half, self._halves))

    def count(self) -> int:
        """Return how often was written, as far as the heads say."""
        return max(int(_HEAD.unpack_from(self._memory, at)[0]) for at in self._halves)

    def _half(self, at: int) -> tuple[int, bytes]:
        count, length, crc = _HEAD.unpack_from(self._memory, at)
        body = self._memory[at + _HEAD.size : at + _HEAD.size + min(length, self._capacity)]
        return (count, body) if zlib.crc32(body) == crc else (0, b"")


class Page:
    """The shared memory of one guard with `streams` streams that it can stop.

    `will` is the guard's; `news` is what the supervisor tells it. Of each stream, `infos` has the
    message type as it was learned, and `said` the last message that went out.
    """

    def __init__(self, descriptor: int, streams: int) -> None:
        self.descriptor = descriptor
        self._memory = mmap.mmap(descriptor, _size(streams))
        self._words = memoryview(self._memory)[: len(Field) * _WORD].cast("Q")
        self._end = mmap.PAGESIZE
        self.will = self._cell(MOST_BYTES)
        self.news = self._cell(_NEWS_BYTES)
        self.infos = [self._cell(_INFO_BYTES) for _ in range(streams)]
        self.said = [self._cell(_SAID_BYTES) for _ in range(streams)]

    @classmethod
    def new(cls, streams: int) -> "Page":
        """Return a page of its own, all zero."""
        descriptor = os.memfd_create("rtron", os.MFD_CLOEXEC)
        try:
            os.truncate(descriptor, _size(streams))
            return cls(descriptor, streams)
        except BaseException:
            os.close(descriptor)
            raise

    def __getitem__(self, field: Field) -> int:
        """Return a word."""
        return self._words[field]

    def __setitem__(self, field: Field, value: int) -> None:
        """Set a word, at once for the other side too."""
        self._words[field] = value

    def close(self) -> None:
        """Let go of the memory; the other side keeps it."""
        self._words.release()
        self._memory.close()
        os.close(self.descriptor)

    def _cell(self, capacity: int) -> Cell:
        at = self._end
        self._end += Cell.size(capacity)
        return Cell(self._memory, at, capacity)


def _size(streams: int) -> int:
    each = Cell.size(_INFO_BYTES) + Cell.size(_SAID_BYTES)
    return mmap.PAGESIZE + Cell.size(MOST_BYTES) + Cell.size(_NEWS_BYTES) + streams * each
