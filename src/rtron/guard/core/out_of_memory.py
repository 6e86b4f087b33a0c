"""What a process without memory does: it ends, so that somebody else can act in its place.

One that lingers drops what it should say, forgets connections, and still looks alive.
"""

import mmap
import os
from typing import NoReturn

_PROBE_SIZE = 1 << 20
_LAST_WORDS = b"ERROR out of memory: the process ends\n"


def exit_out_of_memory() -> NoReturn:
    """End the process at once; nothing here needs memory."""
    os.write(2, _LAST_WORDS)
    os._exit(os.EX_OSERR)


def exit_if_out_of_memory() -> None:
    """End the process while it still can, if the system does not even give it 1 MiB."""
    try:
        mmap.mmap(-1, _PROBE_SIZE).close()
    except (OSError, MemoryError):
        exit_out_of_memory()
