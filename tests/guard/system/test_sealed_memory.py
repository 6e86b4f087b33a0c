"""Nobody who has shared memory can shorten it under the other."""

import mmap
import os

import pytest

from rtron.guard.system.sealed_memory import create_sealed_memory


def test_its_size_stays():
    descriptor = create_sealed_memory("test", mmap.PAGESIZE)
    for size in (0, 2 * mmap.PAGESIZE):
        with pytest.raises(PermissionError):
            os.truncate(descriptor, size)
    with mmap.mmap(descriptor, mmap.PAGESIZE) as memory:
        memory[:3] = b"abc"
        assert os.pread(descriptor, 3, 0) == b"abc"
    os.close(descriptor)
