"""A ROS 2 bag in SQLite (rosbag2_storage_sqlite3, schema versions 1 to 4).

A database can compute: by views, virtual tables and generated columns. So three tables are read,
which must be plain ones, and nothing else is allowed to be run or called.
"""

import sqlite3
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from rtron.errors import InputError
from rtron.sources.bag.common.limits import (
    MAX_CHUNK,
    MAX_CONNECTIONS,
    MAX_INDEX,
    DamageError,
    damaged,
    opened,
)
from rtron.sources.bag.common.reader import BagConnection, BagReading, Message, not_of_ros
from rtron.sources.bag.ros2.offered_qos import offered_qos

_MAGIC = b"SQLite format 3\0"
_RECOVER = "`sqlite3 FILE .recover` saves what is left"
_TABLES = frozenset({"sqlite_master", "topics", "messages", "message_definitions"})
_STEPS = 100_000
_STEPS_ALWAYS = 10**7
_STEPS_PER_BYTE = 32

Row = dict[str, Any]


def read_sqlite(path: Path) -> BagReading:
    """Return a .db3 file's connections and the way to its messages; it names no publishers.

    Raise InputError if the file is no such bag, or is damaged.
    """
    with _faults_named(path), _connected(path) as database:
        tables = _plain_tables(database)
        if not {"topics", "messages"} <= tables:
            help = "a ROS 2 bag has the tables `topics` and `messages`"
            raise InputError("a database, but no ROS 2 bag", path=str(path), help=help)
        definitions = _definitions(database) if "message_definitions" in tables else {}
        topics = _rows(database, "SELECT * FROM topics")
        left_out: dict[str, str] = {}
        found = {_id(row): _connection(row, definitions, left_out) for row in topics}
    return BagReading(
        path=path,
        connections=tuple(filter(None, found.values())),
        messages=partial(_messages, path, found),
        left_out=tuple(left_out.items()),
    )


@contextmanager
def _faults_named(path: Path) -> Iterator[None]:
    """Turn what a damaged database causes into an InputError."""
    try:
        yield
    except (sqlite3.Error, sqlite3.Warning, ValueError, OverflowError) as error:
        raise damaged(path, str(error), _RECOVER) from None
    except KeyError as error:
        raise damaged(path, f"it has no {error}", _RECOVER) from None


@contextmanager
def _connected(path: Path) -> Iterator[sqlite3.Connection]:
    """Open a database for reading; whoever writes to it meanwhile is not waited for."""
    with opened(path) as stream:
        if stream.read(len(_MAGIC)) != _MAGIC:
            raise InputError("no SQLite database", path=str(path), help="is it the right file?")
        size = stream.seek(0, 2)
    uri = path.absolute().as_uri() + "?mode=ro&immutable=1"
    with closing(sqlite3.connect(uri, uri=True)) as database:
        _confine(database, size)
        yield database


def _confine(database: sqlite3.Connection, size: int) -> None:
    if sys.version_info >= (3, 11):
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_CHUNK)
    left = iter(range((_STEPS_ALWAYS + _STEPS_PER_BYTE * size) // _STEPS))
    database.set_progress_handler(lambda: next(left, None) is None, _STEPS)
    database.set_authorizer(_authorised)


def _authorised(action: int, table: str | None, _: object, __: object, within: str | None) -> int:
    """Allow to read tables and what their columns are, but nothing through a view (`within`)."""
    reads = action == sqlite3.SQLITE_READ and table in _TABLES and not within
    asks = action == sqlite3.SQLITE_PRAGMA and table == "table_xinfo"
    allowed = reads or asks or action == sqlite3.SQLITE_SELECT
    return sqlite3.SQLITE_OK if allowed else sqlite3.SQLITE_DENY


def _rows(database: sqlite3.Connection, query: str) -> Iterator[Row]:
    """Yield the rows of a small table; raise DamageError if it is not small."""
    cursor = database.execute(query)
    names = [column[0] for column in cursor.description]
    left = MAX_INDEX
    for count, row in enumerate(cursor):
        left -= sum(len(value) for value in row if isinstance(value, str | bytes))
        if left < 0 or count > MAX_CONNECTIONS:
            raise DamageError("its tables of topics and definitions are too large")
        yield dict(zip(names, row, strict=True))


def _plain_tables(database: sqlite3.Connection) -> set[str]:
    """Return the names of the tables that are there to be read; raise DamageError for others."""
    entries = list(_rows(database, "SELECT name, type, sql FROM sqlite_master"))
    found = {row["name"] for row in entries if row["name"] in _TABLES}
    for row in entries:
        plain = row["type"] == "table" and str(row["sql"]).startswith("CREATE TABLE")
        if row["name"] in found and not plain:
            raise DamageError(f"{row['name']} is no plain table")
    for name in found:
        if any(column["hidden"] for column in _rows(database, f"PRAGMA table_xinfo({name})")):
            raise DamageError(f"{name} has columns that are computed")
    return found


def _definitions(database: sqlite3.Connection) -> dict[str, tuple[str, str]]:
    """Return for each type the format and the text of its definition."""
    return {
        _text(row, "topic_type"): (_text(row, "encoding"), _text(row, "encoded_message_definition"))
        for row in _rows(database, "SELECT * FROM message_definitions")
    }


def _connection(
    row: Row, definitions: dict[str, tuple[str, str]], left_out: dict[str, str]
) -> BagConnection | None:
    topic, type, encoding = (_text(row, name) for name in ("name", "type", "serialization_format"))
    if encoding != "cdr":
        left_out[topic] = not_of_ros(encoding)
        return None
    definition_format, definition = definitions.get(type, ("", ""))
    qos = row.get("offered_qos_profiles", "")
    return BagConnection(
        topic=topic,
        type=type,
        encoding="cdr",
        definition=definition,
        definition_format=definition_format,
        offered_qos=offered_qos(qos) if isinstance(qos, str) else (),
    )


def _text(row: Row, column: str) -> str:
    value = row[column]
    if not isinstance(value, str):
        raise DamageError(f"a {column} that is no text")
    return value


def _id(row: Row) -> int:
    value = row["id"]
    if not isinstance(value, int):
        raise DamageError("a topic's id that is no number")
    return value


def _messages(path: Path, connections: dict[int, BagConnection | None]) -> Iterator[Message]:
    query = "SELECT timestamp, topic_id, data FROM messages ORDER BY timestamp"
    with _faults_named(path), _connected(path) as database:
        for time, topic, data in database.execute(query):
            if type(time) is not int or type(data) is not bytes:
                raise DamageError("a message that is none")
            connection = connections[topic]
            if connection is not None:
                yield time, connection, data
