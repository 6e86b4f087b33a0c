"""Opening the service's database, whose file only its owner may read, and the first admin.

The lock ends with the process, however that ends. On PostgreSQL there may be several replicas.
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sqlalchemy.exc import IntegrityError

from rtron.errors import InputError
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import ConflictError
from rtron.service.domain.principal import UserRole
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.random_secrets import new_password
from rtron.service.store.accounts.users import add_user, all_users
from rtron.service.store.audit import record_event
from rtron.service.store.database import Database, sqlite_file

FIRST_ADMIN = "admin"


def open_database(location: str | Path) -> Database:
    """Open the database, made if it is not there; InputError if it is no place for one."""
    if "://" not in str(location):
        _create_private_file(Path(location))
    return Database(location)


def open_existing_database(location: str | Path) -> Database:
    """Open the database; InputError for a file that is not there: it would be the wrong one."""
    if "://" not in str(location) and not Path(location).exists():
        help = "give --database as `rtron serve` has it"
        raise InputError("there is no such database", path=str(location), help=help)
    return Database(location)


def add_first_admin(database: Database, now: int) -> str | None:
    """Add the user `admin` with every role if there is no user; return the password, told once.

    Of replicas that start at once one adds it.
    """
    password = new_password()
    with suppress(ConflictError, IntegrityError), database.session() as session:
        if all_users(session):
            return None
        add_user(session, now, FIRST_ADMIN, hash_password(password), UserRole)
        record_event(session, now, AuditEvent(who="rtron", action="add user", target=FIRST_ADMIN))
        return password
    return None


def _create_private_file(path: Path) -> None:
    """Make the file for its owner only; SQLite gives those beside it the same mode."""
    try:
        os.close(os.open(path, os.O_RDWR | os.O_CREAT, 0o600))
    except OSError as error:
        help = "give a file in a folder that is there and may be written"
        raise InputError(error.strerror or "cannot be opened", path=str(path), help=help) from None


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
