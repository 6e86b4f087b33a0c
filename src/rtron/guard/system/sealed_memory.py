"""Memory that two processes share, of a size that neither can change."""

import fcntl
import mmap
import os
from typing import ClassVar

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


def write_memory_file(data: bytes) -> int:
    """Return the descriptor of a file in memory, which a program that is started inherits."""
    descriptor = os.memfd_create("rtron-config", os.MFD_CLOEXEC)
    with os.fdopen(os.dup(descriptor), "wb") as file:
        file.write(data)
    return descriptor


def read_memory_file(descriptor: int) -> bytes:
    """Return what is in such a file."""
    return os.pread(descriptor, os.fstat(descriptor).st_size, 0)


_SEALS = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL


def create_sealed_memory(name: str, size: int) -> int:
    """Return the descriptor of so many bytes, all zero; OSError if there are none left.

    One who shortened it would end whoever reads behind its end (memfd_create(2), SIGBUS).
    """
    descriptor = os.memfd_create(name, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    try:
        os.truncate(descriptor, size)
        fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, _SEALS)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor
