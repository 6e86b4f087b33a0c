"""The guard's control socket: a Unix socket for people on the same machine.

Each request is one line of JSON, and so is each response. Only the user that the guard runs as, and
root, may send requests: the kernel names a client's user (unix(7), SO_PEERCRED), and who has logged
in behind it. So two persons are two, even if both send as root.
"""

import fcntl
import json
import logging
import os
import pwd
import socket
from collections.abc import Callable, Collection, Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rtron.errors import SourceError, WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.system.unix_socket import (
    local_users,
    login_user,
    open_own_folder,
    peer_credentials,
    runtime_folder,
)

log = logging.getLogger(__name__)

Response = Mapping[str, Any]
RequestHandler = Callable[[str, Mapping[str, Any]], Response | Future[Response]]
"""Takes the person and the request; returns the response, or a future that the loop's thread sets.

WireError, raised or set, if the request is wrong or refused.
"""

_MAX_REQUEST = 1 << 12
_BACKLOG = 8
_PAUSE_S = 0.5


class ControlSocket:
    """Listens at `path`, which only the guard's user can reach, for `users`: it, and root.

    SourceError if another guard listens there, or if `path` cannot be used.
    """

    def __init__(
        self,
        loop: EventLoop,
        path: Path,
        handler: RequestHandler,
        users: Collection[int] | None = None,
    ) -> None:
        self._loop = loop
        self._path = path
        self._handler = handler
        self._names = {uid: _name(uid) for uid in users or (0, os.getuid())}
        """Who may send requests; looked up now, since a directory of users may hang."""
        self._persons = local_users() | self._names
        self._sock = _listen(path)
        self._inode = _inode_of(path)
        log.info("listening for requests at %s", path)

    def open(self) -> None:
        """Serve from now on."""
        self._loop.watch(self._sock, self._accept, self._pause)

    def _pause(self, error: Exception) -> None:
        """Accept nobody for a moment: no descriptor is left."""
        log.warning("a request cannot be taken: %s", error)
        self._loop.suspend(self._sock, _PAUSE_S)

    def close(self) -> None:
        """Stop listening; a socket that another process has put at the path stays."""
        if _inode_of(self._path) == self._inode:
            self._path.unlink(missing_ok=True)
        self._loop.forget(self._sock)

    def _accept(self) -> None:
        sock, _ = self._sock.accept()
        sock.settimeout(0)
        pid, uid = peer_credentials(sock)
        if uid in self._names:
            _Client(self._loop, sock, self._person(pid, uid), self._handler)
        else:
            log.warning("user %d may not control the guard", uid)
            sock.close()

    def _person(self, pid: int, uid: int) -> str:
        """Return who has logged in behind a client, or its user if nobody has."""
        login = login_user(pid)
        person = uid if login is None else login
        return self._persons.get(person, str(person))


class _Client:
    """One connection: requests line by line, each gets a response."""

    def __init__(
        self, loop: EventLoop, sock: socket.socket, name: str, handler: RequestHandler
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._name = name
        self._handler = handler
        self._buffer = b""
        self._late_count = 0
        self._has_ended = False
        loop.watch(sock, self._on_readable, self._on_error)

    def _on_readable(self) -> None:
        data = self._sock.recv(_MAX_REQUEST)
        self._buffer += data
        *lines, self._buffer = self._buffer.split(b"\n")
        for line in lines:
            self._respond(line)
        if not data or len(self._buffer) > _MAX_REQUEST:
            self._loop.unwatch(self._sock)
            self._has_ended = True
            self._close_when_done()

    def _respond(self, line: bytes) -> None:
        response = self._handle(line)
        if isinstance(response, Future):
            self._late_count += 1
            response.add_done_callback(self._send_late)
        else:
            self._send(response)

    def _handle(self, line: bytes) -> Response | Future[Response]:
        try:
            request = json.loads(line)
            if not isinstance(request, dict):
                return {"error": "a request is a JSON object"}
            return self._handler(self._name, request)
        except (ValueError, RecursionError, WireError) as error:
            return {"error": str(error)}

    def _send_late(self, response: Future[Response]) -> None:
        """Send a response that was not there at once; the client may be gone by now."""
        self._late_count -= 1
        error = response.exception()
        try:
            self._send({"error": str(error)} if error else response.result())
        except OSError as lost:
            self._on_error(lost)
        self._close_when_done()

    def _close_when_done(self) -> None:
        """Close the connection of a client that sends no more when it has all its responses."""
        if self._has_ended and not self._late_count:
            self._loop.forget(self._sock)

    def _send(self, response: Response) -> None:
        self._sock.sendall(json.dumps(response).encode() + b"\n")

    def _on_error(self, error: Exception) -> None:
        log.info("a client of the control socket is gone: %s", error)
        self._loop.forget(self._sock)


def control_path(app: str) -> Path:
    """Return where the guard of an app listens: in the user's own runtime folder."""
    name = "".join(each if each.isalnum() else "_" for each in app) or "app"
    return runtime_folder() / f"rtron-{name[:64]}.sock"


def _listen(path: Path) -> socket.socket:
    try:
        with _lock_folder(path.parent):
            _remove_stale_socket(path)
            return _bind(path)
    except OSError as error:
        reason = error.strerror or str(error)
        raise SourceError(f"{path}: {reason}", help="choose --control-socket PATH") from None


@contextmanager
def _lock_folder(folder: Path) -> Iterator[None]:
    """Lock the folder against other guards that start; it must be the user's own."""
    descriptor = open_own_folder(
        folder, "choose --control-socket PATH in a folder of your own (mode 700)"
    )
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _remove_stale_socket(path: Path) -> None:
    """Remove the socket of a guard that ended without closing it."""
    if not path.is_socket():
        return
    if _is_listening(path):
        help = "stop it first, or choose --control-socket PATH"
        raise SourceError(f"another guard listens at {path}", help=help)
    path.unlink(missing_ok=True)


def _is_listening(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(0)
        try:
            sock.connect(str(path))
        except (ConnectionRefusedError, FileNotFoundError):
            return False
        except BlockingIOError:  # its backlog is full
            return True
        return True


def _bind(path: Path) -> socket.socket:
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


def _inode_of(path: Path) -> tuple[int, int] | None:
    try:
        stat = path.lstat()
    except OSError:
        return None
    return stat.st_dev, stat.st_ino


def _name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)
