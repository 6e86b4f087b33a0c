"""When tokens and sessions were last used: noted where that can be written, and only there."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

from sqlalchemy import update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.service.store.database import Database
from rtron.service.store.tables import SessionRow, TokenRow

log = logging.getLogger(__name__)

_MINUTE = 60_000_000_000
_NOTE_MS = 100
_SELDOM_S = 60.0


class Seldom:
    """Lets something be said once in `_SELDOM_S` seconds; thread-safe."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._said = -_SELDOM_S

    def may(self) -> bool:
        """Tell whether it is time to say it (again)."""
        now = time.monotonic()
        with self._lock:
            is_due = now - self._said >= _SELDOM_S
            self._said = now if is_due else self._said
        return is_due


_warnings = Seldom()


def note_use(database: Database, row: TokenRow | SessionRow, now: int) -> None:
    """Note that a token or session is used, at most once a minute; a failure is only logged."""
    if row.used is not None and now - row.used < _MINUTE:
        return
    kind = type(row)
    try:
        with briefly(database, _NOTE_MS) as session:
            session.execute(update(kind).where(kind.digest == row.digest).values(used=now))
    except SQLAlchemyError as error:
        if _warnings.may():
            log.warning("the last use of logins is not noted: %s", type(error).__name__)


@contextmanager
def briefly(database: Database, patience: int) -> Iterator[Session]:
    """Give a transaction that waits `patience` ms at most for another one that writes."""
    with database.session() as session:
        if not database.is_sqlite:
            session.connection().exec_driver_sql(f"SET LOCAL lock_timeout = {patience:d}")
            yield session
            return
        connection = session.connection()
        before = connection.exec_driver_sql("PRAGMA busy_timeout").scalar_one()
        connection.exec_driver_sql(f"PRAGMA busy_timeout = {patience:d}")
        try:
            yield session
            session.flush()
        finally:
            connection.exec_driver_sql(f"PRAGMA busy_timeout = {before:d}")
