"""Where a guard can be found: one Unix socket for each user and master.

It is an abstract one (unix(7)): it is gone with the process that has bound it, so it is also the
lock against a second guard, and nothing is left behind. Other users can bind such a name too: they
are known by their credentials, and then the guard goes on without being found.
"""

import hashlib
import os
import socket
import struct
from contextlib import suppress
from pathlib import Path

_CREDENTIALS = struct.Struct("3i")


def guard_address(master: str) -> bytes:
    """Return the address of the guard on a master."""
    digest = hashlib.sha256(master.rstrip("/").encode()).hexdigest()[:32]
    return f"\0rtron-guard-{os.getuid()}-{digest}".encode()


def peer_credentials(sock: socket.socket) -> tuple[int, int]:
    """Return the process and the user at the other end, as the kernel says (SO_PEERCRED)."""
    data = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid, uid, _ = _CREDENTIALS.unpack(data)
    return pid, uid


def is_running(pid: int) -> bool:
    """Tell whether a process is there and alive; one that we may not signal or look at is."""
    with suppress(PermissionError):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return False
    with suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_bytes().rpartition(b") ")[2][:1] not in b"ZX"
    return True
