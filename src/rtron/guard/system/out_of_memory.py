"""A process that runs out of memory ends, so that its supervisor can act in its place.

Otherwise it would drop messages and connections, and still look alive.
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
