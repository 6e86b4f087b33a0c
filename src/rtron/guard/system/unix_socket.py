"""Unix sockets: who is at the other end, and addresses that one process of a user can have."""

import hashlib
import os
import socket
import struct
from pathlib import Path

from rtron.errors import SourceError

_CREDENTIALS = struct.Struct("3i")
_NO_LOGIN = (1 << 32) - 1


def peer_credentials(sock: socket.socket) -> tuple[int, int]:
    """Return the process and the user at the other end, as the kernel says (SO_PEERCRED)."""
    data = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    pid, uid, _ = _CREDENTIALS.unpack(data)
    return pid, uid


def login_user(pid: int) -> int | None:
    """Return the user that logged in to a process's session; sudo and su do not change it.

    None if it has no login, as a service, or if the kernel does not say (proc(5), loginuid).
    """
    try:
        uid = int(Path("/proc", str(pid), "loginuid").read_text())
    except (OSError, ValueError):
        return None
    return None if uid == _NO_LOGIN else uid


def local_users() -> dict[int, str]:
    """Return the names of this machine's own users; directories elsewhere are not asked."""
    try:
        lines = Path("/etc/passwd").read_text("utf-8", "replace").splitlines()
    except OSError:
        return {}
    rows = (line.split(":") for line in lines)
    return {int(row[2]): row[0] for row in rows if len(row) > 2 and row[2].isdecimal()}  # noqa: PLR2004 - passwd(5)


def user_name(kind: str, subject: bytes) -> str:
    """Return what this user's process of a kind is called that is there for one subject."""
    return f"rtron-{kind}-{os.getuid()}-{hashlib.sha256(subject).hexdigest()[:32]}"


def runtime_folder() -> Path:
    """Return the user's own folder for sockets; it need not be there yet."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    is_there = bool(runtime) and Path(runtime).is_dir()
    return Path(runtime if is_there else f"/tmp/rtron-{os.getuid()}")  # noqa: S108 - see open_own_folder


def open_own_folder(folder: Path, help: str) -> int:
    """Return a descriptor of a folder that only this user may enter, which is made if need be.

    SourceError with this `help` if others may enter it, OSError if it cannot be opened; a link is
    not followed, since others could change where it leads.
    """
    folder.mkdir(mode=0o700, exist_ok=True)
    flags = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
    descriptor = os.open(folder, flags)
    state = os.fstat(descriptor)
    if state.st_uid != os.getuid() or state.st_mode & 0o077:
        os.close(descriptor)
        raise SourceError(f"others may enter {folder}", help=help)
    return descriptor


def abstract_address(name: str) -> bytes:
    """Return an address in no file system (unix(7)): it is free again when its process ends."""
    return f"\0{name}".encode()
