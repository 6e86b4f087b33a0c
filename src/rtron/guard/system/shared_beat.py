"""The beat of a process, in memory that it shares with the supervisor."""

import mmap
from typing import ClassVar

from rtron.guard.system.sealed_memory import create_sealed_memory
from rtron.vocabulary import SECOND


class SharedBeat:
    """When the process was last well, ns; 0 before its first beat."""

    PERIOD: ClassVar[int] = SECOND // 10
    """The time between two beats, ns."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._words = memoryview(mmap.mmap(descriptor, mmap.PAGESIZE)).cast("Q")

    @classmethod
    def create(cls) -> "SharedBeat":
        """Return one that has not beaten; OSError if there is no memory left."""
        return cls(create_sealed_memory("rtron-beat", mmap.PAGESIZE))

    @property
    def at(self) -> int:
        """The last beat, ns."""
        return self._words[0]

    @at.setter
    def at(self, now: int) -> None:
        self._words[0] = now
