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
from rtron.sources.bag.common.reader import (
    MAX_CHUNK_BYTES,
    MAX_CONNECTIONS,
    MAX_INDEX_BYTES,
    BagConnection,
    BagReader,
    DamageError,
    Message,
    damage_error,
    open_bag_file,
    unknown_encoding,
)
from rtron.sources.bag.ros2.offered_qos import parse_offered_qos

_MAGIC = b"SQLite format 3\0"
_RECOVER_HELP = "`sqlite3 FILE .recover` saves what is left"
_TABLES = frozenset({"sqlite_master", "topics", "messages", "message_definitions"})
_STEPS_PER_CHECK = 100_000
_MIN_STEPS = 10**7
_STEPS_PER_BYTE = 32

Row = dict[str, Any]


def open_sqlite(path: Path) -> BagReader:
    """Return a .db3 file's connections and the way to its messages; it names no publishers.

    Raise InputError if the file is no such bag, or is damaged.
    """
    with _damage_as_input_error(path), _open_database(path) as database:
        tables = _plain_tables(database)
        if not {"topics", "messages"} <= tables:
            help = "a ROS 2 bag has the tables `topics` and `messages`"
            raise InputError("a database, but no ROS 2 bag", path=str(path), help=help)
        definitions = _definitions(database) if "message_definitions" in tables else {}
        topics = _rows(database, "SELECT * FROM topics")
        skipped: dict[str, str] = {}
        connections = {_id(row): _connection(row, definitions, skipped) for row in topics}
    return BagReader(
        path=path,
        connections=tuple(filter(None, connections.values())),
        messages=partial(_messages, path, connections),
        skipped=tuple(skipped.items()),
    )


@contextmanager
def _damage_as_input_error(path: Path) -> Iterator[None]:
    """Turn what a damaged database causes into an InputError."""
    try:
        yield
    except (sqlite3.Error, sqlite3.Warning, ValueError, OverflowError) as error:
        raise damage_error(path, str(error), _RECOVER_HELP) from None
    except KeyError as error:
        raise damage_error(path, f"it has no {error}", _RECOVER_HELP) from None


@contextmanager
def _open_database(path: Path) -> Iterator[sqlite3.Connection]:
    """Open a database for reading; whoever writes to it meanwhile is not waited for."""
    with open_bag_file(path) as stream:
        if stream.read(len(_MAGIC)) != _MAGIC:
            raise InputError("no SQLite database", path=str(path), help="is it the right file?")
        size = stream.seek(0, 2)
    uri = path.absolute().as_uri() + "?mode=ro&immutable=1"
    with closing(sqlite3.connect(uri, uri=True)) as database:
        _restrict(database, size)
        yield database


def _restrict(database: sqlite3.Connection, size: int) -> None:
    if sys.version_info >= (3, 11):
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_CHUNK_BYTES)
    remaining_checks = iter(range((_MIN_STEPS + _STEPS_PER_BYTE * size) // _STEPS_PER_CHECK))
    database.set_progress_handler(lambda: next(remaining_checks, None) is None, _STEPS_PER_CHECK)
    database.set_authorizer(_authorise)


def _authorise(action: int, table: str | None, _: object, __: object, view: str | None) -> int:
    """Allow to read tables and what their columns are, but nothing through a view (`view`)."""
    reads = action == sqlite3.SQLITE_READ and table in _TABLES and not view
    reads_columns = action == sqlite3.SQLITE_PRAGMA and table == "table_xinfo"
    allowed = reads or reads_columns or action == sqlite3.SQLITE_SELECT
    return sqlite3.SQLITE_OK if allowed else sqlite3.SQLITE_DENY


def _rows(database: sqlite3.Connection, query: str) -> Iterator[Row]:
    """Yield the rows of a small table; raise DamageError if it is not small."""
    cursor = database.execute(query)
    names = [column[0] for column in cursor.description]
    remaining = MAX_INDEX_BYTES
    for count, row in enumerate(cursor):
        remaining -= sum(len(value) for value in row if isinstance(value, str | bytes))
        if remaining < 0 or count > MAX_CONNECTIONS:
            raise DamageError("its tables of topics and definitions are too large")
        yield dict(zip(names, row, strict=True))


def _plain_tables(database: sqlite3.Connection) -> set[str]:
    """Return the names of the tables that are there to be read; raise DamageError for others."""
    entries = list(_rows(database, "SELECT name, type, sql FROM sqlite_master"))
    names = {row["name"] for row in entries if row["name"] in _TABLES}
    for row in entries:
        is_plain = row["type"] == "table" and str(row["sql"]).startswith("CREATE TABLE")
        if row["name"] in names and not is_plain:
            raise DamageError(f"{row['name']} is no plain table")
    for name in names:
        if any(column["hidden"] for column in _rows(database, f"PRAGMA table_xinfo({name})")):
            raise DamageError(f"{name} has columns that are computed")
    return names


def _definitions(database: sqlite3.Connection) -> dict[str, tuple[str, str]]:
    """Return for each type the format and the text of its definition."""
    return {
        _text(row, "topic_type"): (_text(row, "encoding"), _text(row, "encoded_message_definition"))
        for row in _rows(database, "SELECT * FROM message_definitions")
    }


def _connection(
    row: Row, definitions: dict[str, tuple[str, str]], skipped: dict[str, str]
) -> BagConnection | None:
    topic, type, encoding = (_text(row, name) for name in ("name", "type", "serialization_format"))
    if encoding != "cdr":
        skipped[topic] = unknown_encoding(encoding)
        return None
    definition_format, definition = definitions.get(type, ("", ""))
    qos = row.get("offered_qos_profiles", "")
    return BagConnection(
        topic=topic,
        type=type,
        encoding="cdr",
        definition=definition,
        definition_format=definition_format,
        offered_qos=parse_offered_qos(qos) if isinstance(qos, str) else (),
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
    with _damage_as_input_error(path), _open_database(path) as database:
        for time, topic, data in database.execute(query):
            if type(time) is not int or type(data) is not bytes:
                raise DamageError("a message that is none")
            connection = connections[topic]
            if connection is not None:
                yield time, connection, data
