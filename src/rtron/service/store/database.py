"""The database: one SQLite file by default, PostgreSQL by URL."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from threading import RLock
from typing import Any

from sqlalchemy import URL, Engine, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError
from sqlalchemy.orm import Session

from rtron.errors import InputError
from rtron.service.store.schema_migration import migrate

_BUSY_TIMEOUT_S = 30
_ANSWER_TIMEOUT_S = 60


class Database:
    """Sessions on one database, whose schema is brought up to date when it is opened.

    `location` is a file, or a URL like `postgresql://user@host/name`; InputError if it is neither,
    SourceError if the server does not answer. What a session has committed outlives a kill of the
    process; with SQLite a power cut may cost the last commits that are not durable, never the file.
    """

    def __init__(self, location: str | Path) -> None:
        self.url = _url(location)
        self.engine = _engine(self.url)
        self._writer = RLock() if self.is_sqlite else nullcontext()
        try:
            migrate(self.engine)
        except BaseException:
            self.close()
            raise

    @property
    def is_sqlite(self) -> bool:
        """Whether it is a SQLite file."""
        return self.engine.dialect.name == "sqlite"

    @contextmanager
    def session(self) -> Iterator[Session]:
        """Give one transaction: committed at the end, taken back by an exception."""
        with Session(self.engine, expire_on_commit=False) as session, session.begin():
            yield session

    @contextmanager
    def write_session(self, *, durable: bool = False) -> Iterator[Session]:
        """Give a transaction that is going to write, and has nobody to wait for when it begins.

        A durable one, once committed, outlives a power cut too: SQLite waits for the disk.

        SQLite knows one writer. Whoever meets another one there sleeps, up to 100 ms at a time;
        so those of this process wait for each other here.
        """
        with self._writer, self.session() as session:
            if durable and self.is_sqlite:
                session.connection().exec_driver_sql("PRAGMA synchronous=FULL")
            yield session

    def close(self) -> None:
        """Close every connection."""
        self.engine.dispose()


def _url(location: str | Path) -> URL:
    if isinstance(location, Path) or "://" not in location:
        return URL.create("sqlite", database=str(location))
    try:
        url = make_url(location)
    except (ArgumentError, ValueError):  # neither says where the password was, nor do we
        help = "for example postgresql://me@host/rtron"
        raise InputError("the URL of the database cannot be read", help=help) from None
    if url.get_backend_name() not in ("sqlite", "postgresql"):
        raise InputError(f"{url.get_backend_name()} is not supported", help="SQLite or PostgreSQL")
    return url.set(drivername="postgresql+pg8000") if url.drivername == "postgresql" else url


def _engine(url: URL) -> Engine:
    quiet = {"hide_parameters": True}  # an error must not tell what was to be stored
    if url.get_backend_name() != "sqlite":
        timeout = {"timeout": _ANSWER_TIMEOUT_S}
        return create_engine(url, pool_pre_ping=True, connect_args=timeout, **quiet)
    engine = create_engine(url, connect_args={"timeout": _BUSY_TIMEOUT_S}, **quiet)
    event.listen(engine, "connect", _set_pragmas)
    event.listen(engine, "checkin", _reset_durability)
    return engine


def _set_pragmas(connection: Any, _record: object) -> None:  # noqa: ANN401 - sqlite3's own
    """Readers and the one writer do not wait for each other (SQLite: Write-Ahead Logging)."""
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")


def _reset_durability(connection: Any, _record: object) -> None:  # noqa: ANN401 - sqlite3's own
    if connection is not None:
        connection.execute("PRAGMA synchronous=NORMAL")
