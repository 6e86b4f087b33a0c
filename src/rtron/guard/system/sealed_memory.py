"""Memory that two processes share, of a size that neither can change."""

import fcntl
import os

_SEALS = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL


def create_sealed_memory(name: str, size: int) -> int:
    """Return the descriptor of so many bytes, all zero; OSError if there are none left.

    One who shortened it would end whoever reads behind its end (memfd_create(2), SIGBUS).
    """
    descriptor = os.memfd_create(name, os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    try:
        os.truncate(descriptor, size)
        fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, _SEALS)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor
