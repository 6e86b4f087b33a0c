"""Records when tokens and sessions were last used; a failed write does not fail the request."""

import logging
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from threading import Lock

from sqlalchemy import Update, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.service.store.database import Database
from rtron.service.store.tables import SessionRow, TokenRow

log = logging.getLogger(__name__)

_MINUTE = 60_000_000_000
_LOCK_TIMEOUT_MS = 100
_WARNING_INTERVAL_S = 60.0


class WarningThrottle:
    """Allows one warning in `_WARNING_INTERVAL_S` seconds; thread-safe."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._last_warning = -_WARNING_INTERVAL_S

    def is_due(self) -> bool:
        """Tell whether it is time to warn (again)."""
        now = time.monotonic()
        with self._lock:
            is_due = now - self._last_warning >= _WARNING_INTERVAL_S
            self._last_warning = now if is_due else self._last_warning
        return is_due


_warnings = WarningThrottle()


def record_use(database: Database, row: TokenRow | SessionRow, now: int) -> None:
    """Record that a token or session is used, at most once a minute; only log a failure."""
    if row.used is not None and abs(now - row.used) < _MINUTE:
        return
    kind = type(row)
    try_update(database, update(kind).where(kind.digest == row.digest).values(used=now))


def record_uses(database: Database, digests: Collection[str], now: int) -> None:
    """Record that these tokens are used; only log a failure."""
    is_used = TokenRow.digest.in_(digests)
    try_update(database, update(TokenRow).where(is_used).values(used=now))


def try_update(database: Database, change: Update) -> None:
    """Change what may wait until the database can be written; only log a failure."""
    try:
        with short_transaction(database, _LOCK_TIMEOUT_MS) as session:
            session.execute(change, execution_options={"synchronize_session": False})
    except SQLAlchemyError as error:
        if _warnings.is_due():
            log.warning("cannot record when logins were last used: %s", type(error).__name__)


@contextmanager
def short_transaction(database: Database, lock_timeout_ms: int) -> Iterator[Session]:
    """Give a transaction that waits `lock_timeout_ms` ms at most for another one that writes."""
    with database.session() as session:
        if not database.is_sqlite:
            session.connection().exec_driver_sql(f"SET LOCAL lock_timeout = {lock_timeout_ms:d}")
            yield session
            return
        connection = session.connection()
        before = connection.exec_driver_sql("PRAGMA busy_timeout").scalar_one()
        connection.exec_driver_sql(f"PRAGMA busy_timeout = {lock_timeout_ms:d}")
        try:
            yield session
            session.flush()
        finally:
            connection.exec_driver_sql(f"PRAGMA busy_timeout = {before:d}")
