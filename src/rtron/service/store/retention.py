"""Forgetting old events, by age and by size, in slices between which others may write.

Settings, the audit log and what is kept with coordination nodes are never forgotten. The clock is
the service's: a robot may think that it is 1970.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sqlalchemy import delete, func, select, text
from sqlalchemy.orm import Session

from rtron.service.store.database import Database
from rtron.service.store.tables import EventRow

BATCH_EVENTS = 1000
"""So many events are deleted in one transaction."""
_DAY = 86_400_000_000_000
_TARGET_SHARE = 0.95
"""What is left of the allowed size once it was too much: not each new event deletes one."""
_NO_OBJECTS = {"synchronize_session": False}
_INDEX_BYTES = 200
"""Bytes of an event in PostgreSQL's indexes, about."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RetentionLimits:
    """What is kept: events of the last `max_days`, of `max_bytes` bytes altogether at most."""

    max_days: float = 30.0
    max_bytes: int = 4 << 30


def prune_events(database: Database, limits: RetentionLimits, now: int) -> Iterator[int]:
    """Delete what is out of bounds at `now` (ns); yield how many events after each transaction.

    Too many bytes take `counts` events first, the oldest first.
    """
    yield from _prune_old(database, now - int(limits.max_days * _DAY))
    excess = _excess_count(database, limits.max_bytes)
    for condition in ("kind = 'counts'", "kind <> 'counts'"):
        for deleted in _prune_matching(database, condition, excess):
            excess -= deleted
            yield deleted


def used_bytes(session: Session) -> int:
    """Return what the events take on disk, about; with SQLite all that the file holds."""
    if session.get_bind().dialect.name == "sqlite":
        pages = "SELECT page_count - freelist_count FROM pragma_page_count, pragma_freelist_count"
        size = "SELECT page_size FROM pragma_page_size"
        return int(session.scalar(text(f"SELECT ({pages}) * ({size})")) or 0)
    newest = "SELECT events.*::text AS row FROM events ORDER BY id DESC LIMIT 1000"
    mean = session.scalar(text(f"SELECT avg(length(row)) FROM ({newest}) AS newest"))  # noqa: S608
    return int(_event_count(session) * (float(mean or 0) + _INDEX_BYTES))


def _prune_old(database: Database, cutoff: int) -> Iterator[int]:
    """Delete what was stored before `cutoff` (ns); ids are in the order of storing."""
    query = select(EventRow.id, EventRow.stored).order_by(EventRow.id).limit(BATCH_EVENTS)
    old = BATCH_EVENTS
    while old == BATCH_EVENTS:
        with database.write_session() as session:
            ids = [id for id, stored in session.execute(query) if stored < cutoff]
            old = _delete(session, ids)
        yield old


def _prune_matching(database: Database, condition: str, max_events: int) -> Iterator[int]:
    """Delete the `max_events` oldest events that fit a condition."""
    query = select(EventRow.id).where(text(condition)).order_by(EventRow.id)
    ids = [0]
    while ids and max_events > 0:
        query_after = query.where(EventRow.id > ids[-1]).limit(min(BATCH_EVENTS, max_events))
        with database.write_session() as session:
            ids = list(session.scalars(query_after))
            max_events -= _delete(session, ids)
        yield len(ids)


def _delete(session: Session, ids: Sequence[int]) -> int:
    session.execute(delete(EventRow).where(EventRow.id.in_(ids)), execution_options=_NO_OBJECTS)
    return len(ids)


def _excess_count(database: Database, size: int) -> int:
    """Return how many events are too many."""
    with database.session() as session:
        used = used_bytes(session)
        if used <= size:
            return 0
        return int(_event_count(session) * (1 - _TARGET_SHARE * size / used))


def _event_count(session: Session) -> int:
    return session.scalar(select(func.count()).select_from(EventRow)) or 0
