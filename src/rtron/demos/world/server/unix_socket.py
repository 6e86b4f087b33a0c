"""The world's socket: a file of its owner alone, taken only where no other world lives."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rtron.errors import SourceError

_BACKLOG = 64
_PRIVATE = 0o177


@contextmanager
def listen_on_unix_socket(path: Path) -> Iterator[socket.socket]:
    """Listen on a Unix socket with mode 0600 until the end of the block, and remove its file.

    SourceError if another world lives there, if the file is no socket, or it cannot be made.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        try:
            _remove_stale_socket(path)
            _bind(listener, path)
        except OSError as error:
            raise SourceError(f"cannot listen on {path}: {error.strerror or error}") from error
        inode = path.stat().st_ino
        try:
            yield listener
        finally:
            _remove(path, inode)


def _remove_stale_socket(path: Path) -> None:
    """Remove the socket of a world that is dead."""
    if not path.exists():
        return
    if not path.is_socket():
        raise SourceError(f"{path} is there, and is no socket")
    if _is_answered(path):
        raise SourceError(f"a world already lives at {path}")
    path.unlink(missing_ok=True)


def _is_answered(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(0)
        try:
            probe.connect(str(path))
        except ConnectionRefusedError:
            return False
        except BlockingIOError:  # its queue is full, so it lives
            return True
    return True


def _bind(listener: socket.socket, path: Path) -> None:
    before = os.umask(_PRIVATE)
    try:
        listener.bind(str(path))
    finally:
        os.umask(before)
    listener.listen(_BACKLOG)
    listener.settimeout(0)


def _remove(path: Path, inode: int) -> None:
    with suppress(OSError):  # somebody else was faster
        if path.stat().st_ino == inode:
            path.unlink()
