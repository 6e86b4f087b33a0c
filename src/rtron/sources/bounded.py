"""Reading a file that somebody else made: never more of it than allowed."""

import sys
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import BinaryIO

from rtron.errors import InputError

STDIN = Path("-")


def read_bounded(path: Path, max_bytes: int) -> bytes:
    """Return a file's bytes, or standard input's for `-`; raise InputError past `max_bytes`."""
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


def _opened(path: Path) -> AbstractContextManager[BinaryIO]:
    return nullcontext(sys.stdin.buffer) if path == STDIN else path.open("rb")
