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

_PROGRAMS = Path("/usr/lib/postgresql")
_START_S = _STOP_S = 60
_QUIET = {"fsync": "off", "listen_addresses": "127.0.0.1", "max_connections": "50"}


def programs():
    """Return the folder of the newest server's programs, None if there is no server."""
    found = sorted(_PROGRAMS.glob("*/bin/postgres"), key=lambda path: int(path.parts[-3]))
    return found[-1].parent if found else None


class PostgreSQL:
    """The server, until `stop`; the superuser `postgres` needs no password."""

    def __init__(self):
        self._folder = Path(mkdtemp(prefix="rtron-pg-"))
        self._numbers = count()
        self._port = free_port()
        self._user = "postgres" if os.geteuid() == 0 else None
        if self._user:
            shutil.chown(self._folder, self._user)
        self._run(
            "initdb", "-D", "data", "-U", "postgres", "-A", "trust", "-E", "UTF8", "--no-sync"
        )
        options = [f"-c {name}={value}" for name, value in _QUIET.items()]
        options += [f"-c unix_socket_directories={self._folder}", f"-p {self._port}"]
        self._pg_ctl("start", _START_S, "-l", "log", "-o", " ".join(options))

    def stop(self):
        """End the server and remove its folder."""
        try:
            self._pg_ctl("stop", _STOP_S, "-m", "immediate")
        finally:
            shutil.rmtree(self._folder)

    def new_database(self):
        """Return the URL of a new, empty database."""
        name = f"rtron{next(self._numbers)}"
        with closing(self._connection()) as connection:
            connection.autocommit = True
            connection.cursor().execute(f"CREATE DATABASE {name}")
        return f"postgresql://postgres@127.0.0.1:{self._port}/{name}"

    def _connection(self):
        return pg8000.dbapi.connect("postgres", "127.0.0.1", "postgres", self._port)

    def _pg_ctl(self, what, limit_s, *args):
        self._run("pg_ctl", what, "-w", "-t", str(limit_s), "-D", "data", *args)

    def _run(self, program, *args):
        environ = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8"}
        command = [str(programs() / program), *args]
        done = subprocess.run(
            command,
            cwd=self._folder,
            user=self._user,
            group=self._user,
            extra_groups=[] if self._user else None,
            env=environ,
            stdout=(out := (self._folder / "output").open("a")),
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            check=False,
        )
        out.close()
        if done.returncode:
            raise RuntimeError(f"{program}: {(self._folder / 'output').read_text()[-2000:]}")
