"""`rtron serve` on a disk that is really full for a while: the system refuses what grows a file."""

import errno
import os
import resource
import shutil
import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx
import pytest
from harness import LIMIT_S, free_port, wait_for

_MOUNT = 'mount -t tmpfs -o size="$1" tmpfs "$2" && cp -a "$3/." "$2" && shift 3 && exec "$@"'
_PRIVATE = ["unshare", "--user", "--map-root-user", "--mount"]


class ServiceProcess:
    """`rtron serve` on a database, a part of whose command stands before."""

    def __init__(self, folder, database, before=()):
        self.port, self.log = free_port(), folder / "service.log"
        self.url = f"http://127.0.0.1:{self.port}"
        command = [sys.executable, "-m", "rtron", "serve", "--port", str(self.port)]
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [*before, *command, "--database", str(database)],
                cwd=folder,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                stdout=log,
                stderr=log,
            )
        try:
            wait_for(self._is_ready, LIMIT_S, str(self.log))
        except BaseException:
            self.close()
            raise

    def _is_ready(self):
        """Tell whether it serves, and has told its database: then its start is over."""
        assert self.process.poll() is None, self.log.read_text()
        if "\ndatabase: " not in self.log.read_text():
            return False
        with suppress(httpx.HTTPError):
            return httpx.get(f"{self.url}/readyz/read", timeout=5).status_code == 200

    def close(self):
        """End it."""
        self.process.terminate()
        self.process.wait(LIMIT_S)


class LimitedFiles:
    """SQLite, while its files may not grow (RLIMIT_FSIZE)."""

    def __init__(self, folder, seed):
        self._folder = folder / "database"
        shutil.copytree(seed, self._folder)
        self.service = ServiceProcess(folder, self._folder / "rtron.db")

    def fill(self):
        """Let nothing grow."""
        sizes = [path.stat().st_size for path in self._folder.iterdir() if path.is_file()]
        self._limit(max(sizes))

    def free(self):
        """Let everything grow."""
        self._limit(resource.RLIM_INFINITY)

    def _limit(self, size):
        limits = (size, resource.RLIM_INFINITY)
        resource.prlimit(self.service.process.pid, resource.RLIMIT_FSIZE, limits)

    def close(self):
        """End the service."""
        self.service.close()


class SmallFileSystem:
    """SQLite on a file system of its own, in memory, of 16 MB, of which most is full."""

    def __init__(self, folder, seed):
        mount = folder / "mount"
        mount.mkdir()
        before = [*_PRIVATE, "sh", "-c", _MOUNT, "sh", "16m", str(mount), str(seed)]
        self.service = ServiceProcess(folder, mount / "rtron.db", before)
        self._ballast = Path(f"/proc/{self.service.process.pid}/root{mount}/ballast")

    def fill(self):
        """Write until the system says that there is no space left."""
        with Path("/dev/zero").open("rb") as zeros, self._ballast.open("wb", 0) as file:
            no_space = pytest.raises(OSError, match=os.strerror(errno.ENOSPC))
            with no_space:
                shutil.copyfileobj(zeros, file)

    def free(self):
        """Make space."""
        self._ballast.unlink()

    def close(self):
        """End the service, and with it its file system."""
        self.service.close()


def can_mount(folder):
    """Tell whether this user may mount a file system in a namespace of their own."""
    (folder / "probe").mkdir()
    (folder / "seed").mkdir()
    before = [*_PRIVATE, "sh", "-c", _MOUNT, "sh", "1m", folder / "probe", folder / "seed"]
    return subprocess.run([*before, "true"], capture_output=True, check=False).returncode == 0


class LimitedServer:
    """PostgreSQL, while its table of events may not grow (RLIMIT_FSIZE)."""

    def __init__(self, folder, server, url, table_bytes):
        self._server, self._table_bytes = server, table_bytes
        self.service = ServiceProcess(folder, url)

    def fill(self):
        """Let no file grow above what the table of events has; there are larger ones."""
        self._server.limit_files(self._table_bytes())

    def free(self):
        """Let everything grow."""
        self._server.limit_files("unlimited")

    def close(self):
        """End the service."""
        self.service.close()


@contextmanager
def closing_disk(disk):
    """Give a disk until the end of the block."""
    try:
        yield disk
    finally:
        disk.close()
