"""Reading a file that somebody else made: never more of it than allowed."""

import sys
from contextlib import AbstractContextManager, nullcontext
from errno import EINVAL
from hashlib import sha256
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import BinaryIO

from rtron.errors import InputError

STDIN = Path("-")
_HASHED = 64 * 2**20
_SHELL = ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")
"""Where a shell's `<(command)` and standard input are."""


def read_bounded(path: Path, max_bytes: int) -> bytes:
    """Return a file's bytes, or standard input's for `-`.

    Raise InputError past `max_bytes`, for what cannot be read, and for a device or a pipe, which
    may never end; the shell's are read.
    """
    try:
        with _opened(path) as stream:
            data = stream.read(max_bytes + 1)
    except OSError as error:
        raise InputError(
            error.strerror or "cannot be read", path=str(path), help="check the path"
        ) from None
    if len(data) > max_bytes:
        mebibytes = max_bytes // 2**20
        raise InputError(
            f"larger than {mebibytes} MiB", path=str(path), help="is it the right file?"
        )
    return data


def content_hash(path: Path) -> str:
    """Return the hash of a file's content; empty for one that cannot be read.

    Past _HASHED bytes its size stands for the rest: no file that is read is longer.
    """
    try:
        with _opened(path) as stream:
            content = sha256(str(path.stat().st_size).encode())
            content.update(stream.read(_HASHED))
            return content.hexdigest()
    except OSError:
        return ""


def _is_endless(path: Path) -> bool:
    mode = path.stat().st_mode
    return not (S_ISREG(mode) or S_ISDIR(mode))


def _opened(path: Path) -> AbstractContextManager[BinaryIO]:
    if path == STDIN:
        return nullcontext(sys.stdin.buffer)
    if _is_endless(path) and not str(path).startswith(_SHELL):
        raise OSError(EINVAL, "is a pipe or a device, no file")
    return path.open("rb")
