"""What a process without memory does: it ends, so that somebody else can act in its place.

One that lingers drops what it should say, forgets connections, and still looks alive.
"""

import mmap
import os
from typing import NoReturn

_LEAST = 1 << 20
_LAST_WORDS = b"ERROR out of memory: the process ends\n"


def end_starved() -> NoReturn:
    """End the process at once; nothing here needs memory."""
    os.write(2, _LAST_WORDS)
    os._exit(os.EX_OSERR)


def end_if_starving() -> None:
    """End the process while it still can, if the system does not even give it 1 MiB."""
    try:
        mmap.mmap(-1, _LEAST).close()
    except (OSError, MemoryError):
        end_starved()
