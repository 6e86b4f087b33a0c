"""One service on one database: what is live is in its memory, and two would not know of each other.

The lock ends with the process, however that ends.
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sqlalchemy import Connection, text
from sqlalchemy.exc import SQLAlchemyError

from rtron.errors import InputError
from rtron.service.store.database import Database

_ADVISORY_LOCK_KEY = 0x5254726F6E
"""The advisory lock of the service in a PostgreSQL database ("RTron")."""


@contextmanager
def hold_instance_lock(database: Database) -> Iterator[None]:
    """Hold the database's lock until the end of the block; InputError if another service has it."""
    if not database.is_sqlite:
        with _database_lock(database):
            yield
        return
    with _file_lock(Path(f"{database.url.database}.lock")):
        yield


@contextmanager
def _database_lock(database: Database) -> Iterator[None]:
    with database.engine.connect() as connection:
        connection.execution_options(isolation_level="AUTOCOMMIT")
        lock = text("SELECT pg_try_advisory_lock(:key)")
        if not connection.scalar(lock, {"key": _ADVISORY_LOCK_KEY}):
            raise _lock_held_error("the database")
        try:
            yield
        finally:
            _unlock(connection)


def _unlock(connection: Connection) -> None:
    """Let the next one begin at once; a server that is gone has forgotten the lock with us."""
    with suppress(SQLAlchemyError):
        connection.execute(text("SELECT pg_advisory_unlock(:key)"), {"key": _ADVISORY_LOCK_KEY})
    connection.invalidate()


@contextmanager
def _file_lock(path: Path) -> Iterator[None]:
    """Lock a file (flock(2)), which stays: a second one of the same name would be another lock."""
    try:
        file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    except OSError as error:
        help = "give a database in a folder that may be written"
        raise InputError(error.strerror or "cannot be opened", path=str(path), help=help) from None
    try:
        _lock_file(file, path)
        yield
    finally:
        os.close(file)


def _lock_file(file: int, path: Path) -> None:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise _lock_held_error(str(path)) from None


def _lock_held_error(location: str) -> InputError:
    help = "end that one first, or give another --database"
    return InputError("another `rtron serve` works on this database", path=location, help=help)
