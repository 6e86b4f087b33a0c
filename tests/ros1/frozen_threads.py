"""Threads of another process that stand still, while its other threads go on (ptrace(2), Linux)."""

import ctypes
import os
from contextlib import contextmanager
from pathlib import Path

import pytest
from harness import wait_for

_SEIZE, _INTERRUPT, _DETACH = 0x4206, 0x4207, 17
_ALL = 0x40000000
"""`__WALL` of waitpid(2)."""
_ptrace = ctypes.CDLL(None, use_errno=True).ptrace
_ptrace.argtypes = [ctypes.c_long] * 4
_ptrace.restype = ctypes.c_long


def threads_named(pid, start):
    """Return the threads of a process whose names begin so."""
    tasks = Path("/proc", str(pid), "task").iterdir()
    return [int(each.name) for each in tasks if (each / "comm").read_text().startswith(start)]


@contextmanager
def frozen(threads):
    """Let threads stand still where they wait for something, with no lock in their hands."""
    held = []
    try:
        for each in threads:
            wait_for(lambda each=each: _freezes(each), what=f"thread {each} to wait")
            held.append(each)
        yield
    finally:
        for each in held:
            if _ptrace(_DETACH, each, 0, 0):  # it was killed: until it is reaped, so is its process
                os.waitpid(each, _ALL)


def _freezes(thread):
    """Freeze a thread; let it go on, and return False, if it was not inside a system call."""
    if _ptrace(_SEIZE, thread, 0, 0):
        pytest.skip(f"this machine lets nobody trace threads: {os.strerror(ctypes.get_errno())}")
    _ptrace(_INTERRUPT, thread, 0, 0)
    os.waitpid(thread, _ALL)
    is_waiting = not Path("/proc", str(thread), "syscall").read_text().startswith("-1")
    if not is_waiting:
        _ptrace(_DETACH, thread, 0, 0)
    return is_waiting
