"""One service on one SQLite file: what is live is in its memory, two would not know of each other.

The lock ends with the process, however that ends. On PostgreSQL there may be several replicas.
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rtron.errors import InputError
from rtron.service.store.database import sqlite_file


@contextmanager
def hold_instance_lock(location: str | Path) -> Iterator[None]:
    """Hold a file's lock until the end of the block; InputError if another service has it.

    It is taken before the database is opened, which may change the schema.
    """
    file = sqlite_file(location)
    if file is None:
        yield
        return
    path = file.resolve()
    _check_single_name(path)
    with _file_lock(path.with_name(f"{path.name}.lock")):
        yield


def _check_single_name(path: Path) -> None:
    """InputError if the database is a hard link: SQLite's own files go by the name, too."""
    if path.exists() and path.stat().st_nlink > 1:
        help = "remove the hard link, or copy the database"
        raise InputError("the database has another name", path=str(path), help=help)


@contextmanager
def _file_lock(path: Path) -> Iterator[None]:
    """Lock a file (flock(2)), which stays: a second one of the same name would be another lock."""
    try:
        file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError as error:
        help = "give a database in a folder that is there and may be written"
        database = str(path.with_suffix(""))
        raise InputError(error.strerror or "cannot be opened", path=database, help=help) from None
    try:
        _lock_file(file, path)
        yield
    finally:
        os.close(file)


def _lock_file(file: int, path: Path) -> None:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        help = "end that one first, or give another --database; several take PostgreSQL"
        message = "another `rtron serve` works on this database"
        raise InputError(message, path=str(path), help=help) from None
