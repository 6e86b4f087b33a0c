"""Opening the service's database, whose file only its owner may read, and the first admin."""

import os
from contextlib import suppress
from pathlib import Path

from sqlalchemy.exc import IntegrityError

from rtron.errors import InputError
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import ConflictError
from rtron.service.domain.roles import UserRole
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.secrets import new_password
from rtron.service.store.accounts.users import add_user, all_users
from rtron.service.store.audit import record_event
from rtron.service.store.database import Database

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
