"""The database: one SQLite file by default, PostgreSQL by URL."""

import os
import socket
import ssl
from collections.abc import Iterator
from contextlib import closing, contextmanager, nullcontext
from functools import cache
from pathlib import Path
from secrets import randbits
from threading import Condition, get_ident
from typing import Any

from sqlalchemy import URL, Connection, Engine, NullPool, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlalchemy.orm import Session
from sqlalchemy.pool import ConnectionPoolEntry

from rtron.errors import InputError
from rtron.service.store.notices import CHANNEL, SENDER, notice_channel
from rtron.service.store.schema_migration import migrate

_POSTGRESQL_PORT = 5432
_SOCKET = "unix_sock"
_OPTIONS = frozenset({_SOCKET, "application_name"})
"""What a URL may add behind `?`."""
_TLS_REQUEST = bytes.fromhex("00000008 04d2162f")
"""PostgreSQL's SSLRequest; the server answers with one byte, `S` if it speaks TLS."""
_BUSY_TIMEOUT_S = 30
_ANSWER_TIMEOUT_S = 60
_REPLICA_BITS = 31
_UNAVAILABLE_CLASSES = frozenset({"08", "25", "40", "53", "55", "57", "58", "XX"})
"""Classes of PostgreSQL's SQLSTATE that are not about what was to be stored."""
_MAX_OVERFLOW = 60
"""More connections than there are threads: no request waits for another's."""


class WriteLock:
    """One writer at a time; who is urgent goes first, and its holder may take it again."""

    def __init__(self) -> None:
        self._changed = Condition()
        self._holder = self._depth = self._urgent = 0

    @contextmanager
    def held(self, *, urgent: bool) -> Iterator[None]:
        """Hold it until the end of the block."""
        self._acquire(urgent=urgent)
        try:
            yield
        finally:
            self._release()

    def _acquire(self, *, urgent: bool) -> None:
        thread = get_ident()
        with self._changed:
            self._urgent += urgent
            self._changed.wait_for(
                lambda: (
                    self._holder == thread or (not self._holder and (urgent or not self._urgent))
                )
            )
            self._urgent -= urgent
            self._holder = thread
            self._depth += 1

    def _release(self) -> None:
        with self._changed:
            self._depth -= 1
            if not self._depth:
                self._holder = 0
                self._changed.notify_all()


class Database:
    """Sessions on one database, whose schema is brought up to date when it is opened.

    `location` is a file, or a URL like `postgresql://user@host/name`; InputError if it is neither,
    SourceError if the server does not answer. What a session has committed outlives a kill of the
    process; with SQLite a power cut may cost the last commits that are not durable, never the file.
    """

    def __init__(self, location: str | Path) -> None:
        self.url = _url(location)
        self.replica = 1 + randbits(_REPLICA_BITS - 1)
        self.engine = _engine(self.url)
        self._writer = WriteLock()
        try:
            migrate(self.engine)
            with Session(self.engine) as session:
                self.channel = notice_channel(session)
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
        info = {SENDER: self.replica, CHANNEL: self.channel}
        with Session(self.engine, expire_on_commit=False, info=info) as session, session.begin():
            yield session

    @contextmanager
    def own_connection(self, timeout_s: float) -> Iterator[Connection]:
        """Give a connection without transactions that is closed at the end of the block.

        It fails if the server takes longer than `timeout_s` to answer.
        """
        arguments = {"timeout": timeout_s}
        engine = create_engine(
            self.url, poolclass=NullPool, connect_args=arguments, isolation_level="AUTOCOMMIT"
        )
        event.listen(engine, "do_connect", _connect_over_socket)
        with closing(engine.connect()) as connection:
            yield connection

    @contextmanager
    def write_session(self, *, durable: bool = False, urgent: bool = False) -> Iterator[Session]:
        """Give a transaction that is going to write, and has nobody to wait for when it begins.

        A durable one, once committed, outlives a power cut too: SQLite waits for the disk. An
        urgent one, of a person who waits for it, goes before the others.

        SQLite knows one writer. Whoever meets another one there sleeps, up to 100 ms at a time;
        so those of this process wait for each other here.
        """
        turn = self._writer.held(urgent=urgent) if self.is_sqlite else nullcontext()
        with turn, self.session() as session:
            if durable and self.is_sqlite:
                session.connection().exec_driver_sql("PRAGMA synchronous=FULL")
            yield session

    def close(self) -> None:
        """Close every connection; one that a thread still uses ends when that gives it back."""
        event.listen(self.engine, "checkin", _close_returned)
        self.engine.dispose()


def is_unavailable(error: Exception) -> bool:
    """Tell whether the database, and not what was to be stored, is the reason of an error."""
    if not isinstance(error, DBAPIError):
        return isinstance(error, PoolTimeoutError)
    if isinstance(error, (OperationalError, InterfaceError)):
        return True
    details = error.orig.args[0] if error.orig and error.orig.args else None
    state = details.get("C", "") if isinstance(details, dict) else ""
    return state[:2] in _UNAVAILABLE_CLASSES


def sqlite_file(location: str | Path) -> Path | None:
    """Return the file of a SQLite database, None for a server; InputError if it is neither."""
    url = _url(location)
    return Path(str(url.database)) if url.get_backend_name() == "sqlite" else None


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
    is_sqlite = url.get_backend_name() == "sqlite"
    unknown = url.query.keys() - (frozenset() if is_sqlite else _OPTIONS)
    if unknown or (_SOCKET in url.query and url.host):
        options = ", ".join(sorted(unknown))
        wrong = f"unknown options: {options}" if unknown else "a host and a socket"
        known = (
            f"{_SOCKET}=PATH in place of a host, application_name; TLS is used where it is there"
        )
        help = "a SQLite file takes none" if is_sqlite else known
        raise InputError(f"the URL of the database has {wrong}", help=help)
    return url.set(drivername="postgresql+pg8000") if url.drivername == "postgresql" else url


def _engine(url: URL) -> Engine:
    quiet = {"hide_parameters": True}  # an error must not tell what was to be stored
    if url.get_backend_name() != "sqlite":
        timeout = {"timeout": _ANSWER_TIMEOUT_S}
        engine = create_engine(
            url, pool_pre_ping=True, connect_args=timeout, max_overflow=_MAX_OVERFLOW, **quiet
        )
        event.listen(engine, "do_connect", _connect_over_socket)
        return engine
    engine = create_engine(
        url, connect_args={"timeout": _BUSY_TIMEOUT_S}, max_overflow=_MAX_OVERFLOW, **quiet
    )
    event.listen(engine, "connect", _set_pragmas)
    event.listen(engine, "checkin", _reset_durability)
    return engine


def _connect_over_socket(
    dialect: Any,  # noqa: ANN401 - SQLAlchemy's
    _record: object,
    arguments: tuple[Any, ...],
    parameters: dict[str, Any],
) -> object:
    """Connect over a socket of ours, with TLS if the server speaks it.

    pg8000 leaves its own open if the server does not answer, and reads all authorities of the
    machine for each connection (20 ms), though it trusts every server.
    """
    host, port = parameters.get("host", "localhost"), parameters.get("port", _POSTGRESQL_PORT)
    path = parameters.pop(_SOCKET, "")
    try:
        connected = _connected(path or (host, port), parameters["timeout"])
    except OSError as error:
        raise dialect.dbapi.InterfaceError(f"{path or f'{host}:{port}'}: {error}") from None
    try:
        connected.sendall(_TLS_REQUEST)
        if connected.recv(1) == b"S":
            connected = _tls_context().wrap_socket(connected, server_hostname=host)
        parameters |= {"sock": connected, "ssl_context": False}
        return dialect.dbapi.Connection(*arguments, **parameters)
    except BaseException:
        # pg8000's file on it would keep a closed one open; a failed handshake has closed its own.
        if (descriptor := connected.detach()) >= 0:
            os.close(descriptor)
        raise


def _connected(place: str | tuple[str, int], timeout_s: float) -> socket.socket:
    """Return a socket that is connected to the path of another one, or to a host's port."""
    if isinstance(place, tuple):
        connected = socket.create_connection(place, timeout_s)
        connected.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        return connected
    connected = socket.socket(socket.AF_UNIX)
    try:
        connected.settimeout(timeout_s)
        connected.connect(place)
    except OSError:
        connected.close()
        raise
    return connected


@cache
def _tls_context() -> ssl.SSLContext:
    """Return what encrypts, and asks no server who it is."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context


def _close_returned(_connection: object, entry: ConnectionPoolEntry) -> None:
    entry.close()


def _set_pragmas(connection: Any, _record: object) -> None:  # noqa: ANN401 - sqlite3's own
    """Readers and the one writer do not wait for each other (SQLite: Write-Ahead Logging)."""
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")


def _reset_durability(connection: Any, _record: object) -> None:  # noqa: ANN401 - sqlite3's own
    if connection is not None:
        connection.execute("PRAGMA synchronous=NORMAL")
