"""A document in memory that two processes share: one writes it, the other reads it at any time.

It is written to the older of two halves, with a count and a CRC: a writer that dies in the middle
leaves the document before readable, whatever order the other processor sees the bytes in.
"""

import mmap
import struct
from zlib import crc32

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
