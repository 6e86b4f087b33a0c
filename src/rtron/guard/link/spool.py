"""Events on disk until the service has them: each once, in order, within a bound.

One SQLite file in WAL mode: what `add` has returned from outlives a kill of the process (not a
power cut, for which a robot would have to wait for its disk with every event).
"""

import asyncio
import sqlite3
from collections.abc import Iterable, Sequence
from contextlib import closing
from pathlib import Path
from uuid import uuid4

from rtron.errors import InputError
from rtron.vocabulary import EventKind, GuardEvent, GuardEventLevel

MAX_EVENTS = 200_000
"""Events that may wait; above it counts are dropped, above twice as many everything is."""
_SCHEMA = """
CREATE TABLE IF NOT EXISTS events (
    position INTEGER PRIMARY KEY AUTOINCREMENT,
    run TEXT NOT NULL, number INTEGER NOT NULL, body BLOB NOT NULL,
    UNIQUE (run, number)
);
CREATE TABLE IF NOT EXISTS seen (run TEXT PRIMARY KEY, number INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS facts (name TEXT PRIMARY KEY, value TEXT NOT NULL);
"""
Row = tuple[int, str, int, bytes]
"""Position, run, number and the event as JSON."""


def _open(path: Path) -> sqlite3.Connection:
    db = sqlite3.connect(path, isolation_level=None)
    try:
        db.execute("PRAGMA journal_mode=WAL")
        db.execute("PRAGMA synchronous=NORMAL")
        db.executescript(_SCHEMA)
    except sqlite3.Error:
        db.close()
        raise
    return db


class Spool:
    """The events of all runs that wait, and the highest number that was ever seen of each run."""

    def __init__(self, path: Path, max_events: int = MAX_EVENTS) -> None:
        """InputError if the file cannot be used."""
        self._max_events = max_events
        self.is_empty = asyncio.Event()
        try:
            self._db = _open(path)
        except sqlite3.Error as error:
            help = "choose another folder with --state-dir, or remove the file"
            raise InputError(f"{path}: {error}", help=help) from None
        self.run = self._read_fact("run") or self._write_fact("run", f"link-{uuid4().hex}")
        self.waiting = self._query_number("SELECT count(*) FROM events")
        self.lost = int(self._read_fact("lost") or 0)

    @property
    def waiting(self) -> int:
        """How many events wait."""
        return self._waiting

    @waiting.setter
    def waiting(self, number: int) -> None:
        self._waiting = number
        self.is_empty.clear() if number else self.is_empty.set()

    def close(self) -> None:
        """Close the file."""
        self._db.close()

    def add(self, events: Iterable[tuple[GuardEvent, bytes]]) -> None:
        """Keep events, each with its JSON; those that were seen before are not kept twice."""
        waiting, lost = self.waiting, self.lost
        try:
            with self._db, closing(self._db.cursor()) as cursor:
                cursor.execute("BEGIN")
                for event, body in events:
                    self._add(cursor, event, body)
                self._write_fact("lost", str(self.lost))
        except BaseException:  # `with` has taken the transaction back
            self.waiting, self.lost = waiting, lost
            raise

    def report_lost(self, at: int, count: int, why: str, about: str = "") -> GuardEvent:
        """Return the event, of the link's own run, that tells how many events are missing."""
        number = self.highest_number(self.run) + 1
        values = {"events": count, "run": about}
        return GuardEvent(
            run=self.run,
            number=number,
            at=at,
            kind=EventKind.LOST,
            level=GuardEventLevel.WARNING,
            reason=f"{count} events were lost: {why}",
            values=values,
        )

    def take_lost(self) -> int:
        """Return how many events found no place since the last call, if there is place again."""
        if not self.lost or self.waiting >= self._max_events:
            return 0
        count, self.lost = self.lost, 0
        return count

    def events_after(self, position: int, limit: int) -> Sequence[Row]:
        """Return the next events behind a position."""
        order = "WHERE position > ? ORDER BY position LIMIT ?"
        rows = self._db.execute(
            f"SELECT position, run, number, body FROM events {order}",  # noqa: S608 - our own text
            (position, limit),
        )
        return rows.fetchall()

    def forget(self, run: str, number: int) -> None:
        """Drop what the service has."""
        where = "WHERE run = ? AND number <= ?"
        cursor = self._db.execute(f"DELETE FROM events {where}", (run, number))  # noqa: S608
        self.waiting -= cursor.rowcount

    def highest_number(self, run: str) -> int:
        """Return the highest number that was ever kept, or counted as lost, of a run."""
        return self._query_number("SELECT coalesce(max(number), 0) FROM seen WHERE run = ?", run)

    def prune(self, run: str) -> None:
        """Forget the numbers of runs that are over and of which nothing waits; `run` goes on."""
        waits = "SELECT run FROM events"
        over = f"DELETE FROM seen WHERE run NOT IN (?, ?) AND run NOT IN ({waits})"  # noqa: S608
        self._db.execute(over, (run, self.run))

    def _add(self, cursor: sqlite3.Cursor, event: GuardEvent, body: bytes) -> None:
        if event.number <= self.highest_number(event.run):
            return
        cursor.execute("INSERT OR REPLACE INTO seen VALUES (?, ?)", (event.run, event.number))
        bound = self._max_events if event.kind is EventKind.COUNTS else 2 * self._max_events
        if self.waiting >= bound:
            self.lost += 1
            return
        row = (event.run, event.number, body)
        cursor.execute("INSERT INTO events (run, number, body) VALUES (?, ?, ?)", row)
        self.waiting += 1

    def _query_number(self, query: str, *values: object) -> int:
        return int(self._db.execute(query, values).fetchone()[0])

    def _read_fact(self, name: str) -> str:
        row = self._db.execute("SELECT value FROM facts WHERE name = ?", (name,)).fetchone()
        return str(row[0]) if row else ""

    def _write_fact(self, name: str, value: str) -> str:
        self._db.execute("INSERT OR REPLACE INTO facts VALUES (?, ?)", (name, value))
        return value
