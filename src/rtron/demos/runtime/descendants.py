"""What our processes have started themselves, wherever it has gone: a mark tells it.

Descendants inherit the environment, also those that left their session or lost their parent.
"""

import os
import signal
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

MARK = "RTRON_STARTED_BY"
"""The variable of the environment that holds the mark."""
_LIMIT = 10.0
_PAUSE = 0.02


def new_mark() -> str:
    """Return a mark that nobody else has."""
    return uuid4().hex


def kill_descendants(marks: Collection[str]) -> None:
    """Kill every process that has one of the marks, and wait until they are gone."""
    markers = {f"{MARK}={mark}".encode() for mark in marks}
    deadline = time.monotonic() + _LIMIT
    while _kill_marked(markers) and time.monotonic() < deadline:
        time.sleep(_PAUSE)


def _kill_marked(markers: Collection[bytes]) -> bool:
    """Kill those that are there; tell whether there were any."""
    found = False
    for folder in Path("/proc").glob("[0-9]*"):
        if _has_marker(folder, markers):
            found |= _kill(int(folder.name), markers)
    return found


def _kill(pid: int, markers: Collection[bytes]) -> bool:
    with suppress(ProcessLookupError), _open_pidfd(pid) as handle:
        # A pid may have been given to another process meanwhile; the handle stays with one.
        if _has_marker(Path("/proc", str(pid)), markers):
            signal.pidfd_send_signal(handle, signal.SIGKILL)
            return True
    return False


@contextmanager
def _open_pidfd(pid: int) -> Iterator[int]:
    handle = os.pidfd_open(pid)
    try:
        yield handle
    finally:
        os.close(handle)


def _has_marker(folder: Path, markers: Collection[bytes]) -> bool:
    """Tell whether a process has a mark; one that is gone, or a zombie, has none."""
    try:
        return not set((folder / "environ").read_bytes().split(b"\0")).isdisjoint(markers)
    except OSError:
        return False
