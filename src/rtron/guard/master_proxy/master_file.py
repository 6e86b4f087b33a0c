"""How the guard finds the master behind its proxy: a file that only its user can read.

The file is locked while its proxy runs; what a dead one left behind is not believed.
"""

import fcntl
import json
import os
import stat
from contextlib import suppress
from pathlib import Path
from tempfile import mkstemp

from rtron.errors import SourceError, WireError
from rtron.guard.core.control_socket import control_path
from rtron.guard.master_proxy.name_registry import is_local
from rtron.wire.ros1.xmlrpc import split_uri

_MAX_BYTES = 1 << 12


def find_private_master(uri: str) -> str:
    """Return the master behind the proxy of this user at `uri`, or `uri` if there is none."""
    try:
        host, port = split_uri(uri)
    except WireError:
        return uri
    if not is_local(host):
        return uri
    return next(filter(None, map(_announced_master, candidate_paths(port))), uri)


def candidate_paths(port: int) -> list[Path]:
    """Return where the proxy at a public port may tell its master, its first choice first.

    It may have been started without the session's XDG_RUNTIME_DIR, by systemd for instance.
    """
    chosen, uid = control_path("master").parent, os.getuid()
    folders = dict.fromkeys((chosen, Path(f"/run/user/{uid}"), Path(f"/tmp/rtron-{uid}")))  # noqa: S108
    return [folder / f"rtron-master-{port}.json" for folder in folders]


class MasterFile:
    """Tells, until closed, the master behind the proxy at a port; SourceError if it cannot."""

    def __init__(self, port: int, private: str) -> None:
        self._path = candidate_paths(port)[0]
        try:
            self._descriptor = _write(self._path, private)
        except OSError as error:
            reason = error.strerror or str(error)
            help = "the guard finds the master by this file; set XDG_RUNTIME_DIR to your own folder"
            raise SourceError(f"{self._path}: {reason}", help=help) from None

    def close(self) -> None:
        """Take the file away, unless another proxy has put its own there."""
        with suppress(OSError):
            if os.path.samestat(os.fstat(self._descriptor), self._path.lstat()):
                self._path.unlink()
        os.close(self._descriptor)


def _write(path: Path, private: str) -> int:
    """Put a new file in the place of any other, locked before anybody can see it."""
    path.parent.mkdir(mode=0o700, exist_ok=True)
    if not _is_private(path.parent.lstat()):
        raise PermissionError(f"others may enter {path.parent}")
    descriptor, name = mkstemp(dir=path.parent, prefix=f"{path.stem}-")  # O_EXCL, mode 600
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.write(descriptor, json.dumps({"private": private}).encode())
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        os.close(descriptor)
        raise
    return descriptor


def _announced_master(path: Path) -> str:
    """Return what a running proxy of this user tells at a path; nothing if there is none."""
    try:
        return _read(path)
    except (WireError, OSError, ValueError):
        return ""


def _read(path: Path) -> str:
    if not _is_private(path.parent.lstat()):
        return ""
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode) or not _is_private(found) or not _is_locked(descriptor):
            return ""
        document = json.loads(os.read(descriptor, _MAX_BYTES))
        private = document.get("private") if isinstance(document, dict) else None
        split_uri(private)
        return str(private)
    finally:
        os.close(descriptor)


def _is_private(found: os.stat_result) -> bool:
    return found.st_uid == os.getuid() and not found.st_mode & 0o077


def _is_locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    return False
