"""A PostgreSQL server of the bench's own: Debian's, as it is installed, on a free port."""

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rtron.demos.runtime.isolation import free_port

_PROGRAMS = Path("/usr/lib/postgresql")
_START_S = 60.0


@contextmanager
def postgresql_server(folder: Path) -> Iterator[tuple[int, int]]:
    """Run a server until the end of the block; give its process and port.

    The superuser `postgres` needs no password.
    """
    programs = max(_PROGRAMS.glob("*/bin"), key=lambda path: int(path.parent.name))
    user = "postgres" if os.geteuid() == 0 else None
    folder.mkdir()
    if user:
        shutil.chown(folder, user)
        folder.parent.chmod(0o755)
    initdb = [programs / "initdb", "-D", folder / "data", "-U", "postgres", "-A", "trust"]
    _command(initdb, folder, user).wait()
    port = free_port()
    options = ["-p", str(port), "-h", "127.0.0.1", "-k", str(folder)]
    server = _command([programs / "postgres", "-D", folder / "data", *options], folder, user)
    try:
        _wait_ready([str(programs / "pg_isready"), "-q", "-h", "127.0.0.1", "-p", str(port)])
        yield server.pid, port
    finally:
        server.terminate()
        server.wait()


def _command(
    arguments: list[str | Path], folder: Path, user: str | None
) -> subprocess.Popen[bytes]:
    with (folder.parent / "postgresql.log").open("ab") as log:
        return subprocess.Popen(
            arguments,
            cwd=folder,
            user=user,
            group=user,
            extra_groups=[] if user else None,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
        )


def _wait_ready(probe: list[str]) -> None:
    deadline = time.monotonic() + _START_S
    while subprocess.run(probe, check=False).returncode:
        if time.monotonic() > deadline:
            raise TimeoutError("PostgreSQL does not start")
        time.sleep(0.1)
