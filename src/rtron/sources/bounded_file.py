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
_MAX_HASHED_BYTES = 64 * 2**20
_USUAL_BYTES = 2**16
"""What most files are smaller than: for these no memory is mapped."""


def read_bounded(path: Path, max_bytes: int) -> bytes:
    """Return a file's bytes, or standard input's for `-`.

    Raise InputError past `max_bytes`, and for what cannot be read.
    """
    try:
        with _open(path) as stream:
            data = _read_at_most(stream, max_bytes + 1)
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


def read_regular_file(path: Path, max_bytes: int) -> bytes:
    """Return the bytes of a file that nobody named, as `read_bounded` does.

    Raise InputError for a pipe or a device, too, which may never end.
    """
    try:
        _require_regular_or_folder(path)
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(path)) from None
    return read_bounded(path, max_bytes)


def content_hash(path: Path) -> str:
    """Return the hash of a file's content; empty for one that cannot be read.

    Past _HASHED bytes its size stands for the rest: no file that is read is longer.
    """
    try:
        _require_regular_or_folder(path)
        with path.open("rb") as stream:
            content = sha256(str(path.stat().st_size).encode())
            content.update(_read_at_most(stream, _MAX_HASHED_BYTES))
            return content.hexdigest()
    except OSError:
        return ""


def _read_at_most(stream: BinaryIO, most: int) -> bytes:
    """Return the bytes of a stream, so many at most; asked for many, it makes room for all."""
    start = stream.read(min(most, _USUAL_BYTES))
    return start if len(start) < _USUAL_BYTES else start + stream.read(most - len(start))


def _require_regular_or_folder(path: Path) -> None:
    mode = path.stat().st_mode
    if not (S_ISREG(mode) or S_ISDIR(mode)):
        raise OSError(EINVAL, "is a pipe or a device, no file")


def _open(path: Path) -> AbstractContextManager[BinaryIO]:
    return nullcontext(sys.stdin.buffer) if path == STDIN else path.open("rb")
