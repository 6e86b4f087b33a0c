"""A PostgreSQL server of the tests' own: Debian's, on a free port, in a folder that is removed."""

import os
import shutil
import subprocess
from contextlib import closing
from itertools import count
from pathlib import Path
from tempfile import mkdtemp

import pg8000.dbapi
from harness import free_port

from rtron.service.store.database import Database

_PROGRAMS = Path("/usr/lib/postgresql")
_START_S = _STOP_S = 60
_MEMORY = Path("/dev/shm")
_ROOM = 4 << 30
"""Bytes; a database takes 8 MB."""
_QUIET = {"fsync": "off", "listen_addresses": "127.0.0.1"}


def programs():
    """Return the folder of the newest server's programs, None if there is no server."""
    found = sorted(_PROGRAMS.glob("*/bin/postgres"), key=lambda path: int(path.parts[-3]))
    return found[-1].parent if found else None


def _new_folder():
    """Make a folder in memory, if there is room: to copy a database takes a tenth there."""
    is_roomy = _MEMORY.is_dir() and shutil.disk_usage(_MEMORY).free > _ROOM
    return Path(mkdtemp(prefix="rtron-pg-", dir=_MEMORY if is_roomy else None))


class PostgreSQL:
    """The server, until `stop`; the superuser `postgres` needs no password."""

    def __init__(self, *options):
        """`options` are those of `initdb`."""
        self._folder = _new_folder()
        self._numbers, self._migrated = count(), ""
        self._port = free_port()
        self._user = "postgres" if os.geteuid() == 0 else None
        if self._user:
            shutil.chown(self._folder, self._user)
        self._run(
            "initdb",
            "-D",
            "data",
            "-U",
            "postgres",
            "-A",
            "trust",
            "-E",
            "UTF8",
            "--no-sync",
            *options,
        )
        settings = [f"-c {name}={value}" for name, value in _QUIET.items()]
        settings += [f"-c unix_socket_directories={self._folder}", f"-p {self._port}"]
        self._pg_ctl("start", _START_S, "-l", "log", "-o", " ".join(settings))

    @property
    def socket_path(self):
        """The server's socket in the file system."""
        return self._folder / f".s.PGSQL.{self._port}"

    def stop(self):
        """End the server and remove its folder."""
        try:
            self._pg_ctl("stop", _STOP_S, "-m", "immediate")
        finally:
            shutil.rmtree(self._folder)

    def empty_database(self):
        """Return the URL of a new database without tables."""
        return self._create("template1")

    def new_database(self):
        """Return the URL of a new database that has its tables: a copy takes less than they do."""
        if not self._migrated:
            self._migrated = self.empty_database()
            Database(self._migrated).close()
        return self.copy_database(self._migrated)

    def copy_database(self, url):
        """Return the URL of a copy of a database, to which nobody is connected."""
        return self._create(url.rpartition("/")[2])

    def _create(self, template):
        name = f"rtron{next(self._numbers)}"
        with closing(self._connection()) as connection:
            connection.autocommit = True
            connection.cursor().execute(f"CREATE DATABASE {name} TEMPLATE {template}")
        return f"postgresql://postgres@127.0.0.1:{self._port}/{name}"

    def limit_files(self, size):
        """Let no file of the server grow above a size, bytes or "unlimited" (RLIMIT_FSIZE)."""
        pid = (self._folder / "data/postmaster.pid").read_text().split()[0]
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        for each in (pid, *children):
            command = ["prlimit", "--pid", each, f"--fsize={size}:"]
            subprocess.run(command, **self._owner(), check=True, capture_output=True)

    def _owner(self):
        """Return how a process is started as the server's user, who is never root."""
        groups = [] if self._user else None
        return {"user": self._user, "group": self._user, "extra_groups": groups}

    def _connection(self):
        return pg8000.dbapi.connect(
            "postgres", "127.0.0.1", "postgres", self._port, ssl_context=False
        )

    def _pg_ctl(self, what, limit_s, *args):
        self._run("pg_ctl", what, "-w", "-t", str(limit_s), "-D", "data", *args)

    def _run(self, program, *args):
        environ = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8"}
        command = [str(programs() / program), *args]
        done = subprocess.run(
            command,
            cwd=self._folder,
            **self._owner(),
            env=environ,
            stdout=(out := (self._folder / "output").open("a")),
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            check=False,
        )
        out.close()
        if done.returncode:
            raise RuntimeError(f"{program}: {(self._folder / 'output').read_text()[-2000:]}")
