"""Unix sockets: who is at the other end, and addresses that one process of a user can have."""

import hashlib
import os
import socket
import struct

_CREDENTIALS = struct.Struct("3i")


def peer_credentials(sock: socket.socket) -> tuple[int, int]:
    """Return the process and the user at the other end, as the kernel says (SO_PEERCRED)."""
    data = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid, uid, _ = _CREDENTIALS.unpack(data)
    return pid, uid


def user_name(kind: str, subject: bytes) -> str:
    """Return what this user's process of a kind is called that is there for one subject."""
    return f"rtron-{kind}-{os.getuid()}-{hashlib.sha256(subject).hexdigest()[:32]}"


def is_taken(address: bytes) -> bool:
    """Tell whether a process has an address, without a word to it."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        try:
            sock.bind(address)
        except OSError:
            return True
        return False


def abstract_address(name: str) -> bytes:
    """Return an address in no file system (unix(7)): it is free again when its process ends."""
    return f"\0{name}".encode()
