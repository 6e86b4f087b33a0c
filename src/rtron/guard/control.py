"""The guard's local door: a socket in the file system, for people on the same machine.

One JSON object a line in, one out. Who asks is what the kernel says, not what the caller says: only
the user that the guard runs as, and root, are listened to (unix(7), SO_PEERCRED).
"""

import json
import logging
import os
import pwd
import socket
import struct
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rtron.errors import SourceError, WireError
from rtron.guard.transport.ros1.loop import Loop

log = logging.getLogger(__name__)

Answer = Callable[[str, Mapping[str, Any]], Mapping[str, Any]]
"""Takes who asks and what; returns the answer. WireError if the request is wrong."""

_LONGEST = 1 << 12
_BACKLOG = 8
_CREDENTIALS = struct.Struct("3i")


class Control:
    """Listens at `path`, which only the guard's user can reach."""

    def __init__(self, loop: Loop, path: Path, answer: Answer) -> None:
        self._loop = loop
        self._path = path
        self._answer = answer
        self._sock = _listen(path)
        loop.watch(self._sock, self._accept, lambda error: None)

    def close(self) -> None:
        """Listen no more."""
        self._loop.forget(self._sock)
        self._path.unlink(missing_ok=True)

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
    runtime = os.environ.get("XDG_RUNTIME_DIR") or f"/tmp/rtron-{os.getuid()}"  # noqa: S108
    name = "".join(each if each.isalnum() else "_" for each in app) or "app"
    return Path(runtime) / f"rtron-{name[:64]}.sock"


def _listen(path: Path) -> socket.socket:
    folder = path.parent
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        if folder.stat().st_uid != os.getuid() or folder.stat().st_mode & 0o077:
            help = "choose --control PATH in a folder of your own (mode 700)"
            raise SourceError(f"others may enter {folder}", help=help)
        path.unlink(missing_ok=True)
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        before = os.umask(0o177)
        try:
            sock.bind(str(path))
        finally:
            os.umask(before)
        sock.listen(_BACKLOG)
    except OSError as error:
        raise SourceError(f"{path}: {error.strerror}", help="choose --control PATH") from None
    sock.settimeout(0)
    return sock


def _name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
