"""The guard's local door: a socket in the file system, for people on the same machine.

One JSON object a line in, one out. Who asks is what the kernel says, not what the caller says: only
the user that the guard runs as, and root, are listened to (unix(7), SO_PEERCRED).
"""

import fcntl
import json
import logging
import os
import pwd
import socket
import struct
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rtron.errors import SourceError, WireError
from rtron.guard.core.event_loop import Loop

log = logging.getLogger(__name__)

Answer = Callable[[str, Mapping[str, Any]], Mapping[str, Any]]
"""Takes who asks and what; returns the answer. WireError if the request is wrong."""

_LONGEST = 1 << 12
_BACKLOG = 8
_CREDENTIALS = struct.Struct("3i")


class Control:
    """Listens at `path`, which only the guard's user can reach.

    SourceError if another guard listens there, or if nobody can.
    """

    def __init__(self, loop: Loop, path: Path, answer: Answer) -> None:
        self._loop = loop
        self._path = path
        self._answer = answer
        self._sock = _listen(path)
        self._file = _file_at(path)
        loop.watch(self._sock, self._accept, lambda error: None)
        log.info("listening for overrides at %s", path)

    def close(self) -> None:
        """Listen no more; a socket that somebody else has put at the path stays."""
        if _file_at(self._path) == self._file:
            self._path.unlink(missing_ok=True)
        self._loop.forget(self._sock)

    def _accept(self) -> None:
        sock, _ = self._sock.accept()
        sock.settimeout(0)
        _, uid, _ = _CREDENTIALS.unpack(
            sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
        )
        if uid in (0, os.getuid()):
            _Caller(self._loop, sock, _name(uid), self._answer)
        else:
            log.warning("user %s may not control the guard", _name(uid))
            sock.close()


class _Caller:
    """One connection: requests line by line, each answered at once."""

    def __init__(self, loop: Loop, sock: socket.socket, name: str, answer: Answer) -> None:
        self._loop = loop
        self._sock = sock
        self._name = name
        self._answer = answer
        self._waiting = b""
        loop.watch(sock, self._readable, self._broken)

    def _readable(self) -> None:
        data = self._sock.recv(_LONGEST)
        self._waiting += data
        *lines, self._waiting = self._waiting.split(b"\n")
        for line in lines:
            self._sock.sendall(json.dumps(self._answered(line)).encode() + b"\n")
        if not data or len(self._waiting) > _LONGEST:
            self._loop.forget(self._sock)

    def _answered(self, line: bytes) -> Mapping[str, Any]:
        try:
            request = json.loads(line)
            if not isinstance(request, dict):
                return {"error": "a request is a JSON object"}
            return self._answer(self._name, request)
        except (ValueError, RecursionError, WireError) as error:
            return {"error": str(error)}

    def _broken(self, error: Exception) -> None:
        log.info("a caller of the guard is gone: %s", error)
        self._loop.forget(self._sock)


def control_path(app: str) -> Path:
    """Return where the guard of an app listens: in the user's own runtime folder."""
    # The folder is checked before it is used.
    named = os.environ.get("XDG_RUNTIME_DIR", "")
    runtime = named if named and Path(named).is_dir() else f"/tmp/rtron-{os.getuid()}"  # noqa: S108
    name = "".join(each if each.isalnum() else "_" for each in app) or "app"
    return Path(runtime) / f"rtron-{name[:64]}.sock"


def _listen(path: Path) -> socket.socket:
    try:
        path.parent.mkdir(mode=0o700, exist_ok=True)
        with _alone_in(path.parent):
            _clear(path)
            return _bound(path)
    except OSError as error:
        told = error.strerror or str(error)
        raise SourceError(f"{path}: {told}", help="choose --control PATH") from None


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Keep other guards that start from looking at the folder; it must be the user's own."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        state = os.fstat(descriptor)
        if state.st_uid != os.getuid() or state.st_mode & 0o077:
            help = "choose --control PATH in a folder of your own (mode 700)"
            raise SourceError(f"others may enter {folder}", help=help)
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _clear(path: Path) -> None:
    """Remove the socket of a guard that ended without closing it."""
    if not path.is_socket():
        return
    if _listens(path):
        help = "stop it first, or choose --control PATH"
        raise SourceError(f"another guard listens at {path}", help=help)
    path.unlink(missing_ok=True)


def _listens(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(0)
        try:
            sock.connect(str(path))
        except (ConnectionRefusedError, FileNotFoundError):
            return False
        except BlockingIOError:  # it has not accepted those who came before
            return True
        return True


def _bound(path: Path) -> socket.socket:
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    before = os.umask(0o177)
    try:
        sock.bind(str(path))
        sock.listen(_BACKLOG)
    except OSError:
        sock.close()
        raise
    finally:
        os.umask(before)
    sock.settimeout(0)
    return sock


def _file_at(path: Path) -> tuple[int, int] | None:
    try:
        found = path.lstat()
    except OSError:
        return None
    return found.st_dev, found.st_ino


def _name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
