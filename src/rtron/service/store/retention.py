"""Forgetting old events, by age and by size: on SQLite in slices between which others may write.

On PostgreSQL whole partitions go. Settings, the audit log and what is kept with coordination nodes
are never forgotten. What does not fit its chain does not go for its age: it shows that somebody has
changed something. The clock is the service's: a robot may think that it is 1970.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from sqlalchemy import Select, delete, func, or_, select, text
from sqlalchemy.orm import Session

from rtron.service.store.chain_pruning import ChainCutter, cut_chains
from rtron.service.store.database import Database
from rtron.service.store.partitions.event_partitions import partition_bytes, partition_numbers
from rtron.service.store.partitions.partition_pruning import prune_partitions
from rtron.service.store.tables import EventRow
from rtron.vocabulary import EventKind

BATCH_EVENTS = 1000
"""So many events are deleted in one transaction."""
_DAY = 86_400_000_000_000
_TARGET_SHARE = 0.95
"""What is left of the allowed size once it was too much: not each new event deletes one."""
_NO_OBJECTS = {"synchronize_session": False}
_BEFORE_ALL = -1 << 62


@dataclass(frozen=True, slots=True, kw_only=True)
class RetentionLimits:
    """What is kept: events of the last `max_days`, of `max_bytes` bytes altogether at most."""

    max_days: float = 30.0
    max_bytes: int = 4 << 30

    @property
    def max_age(self) -> int:
        """How long something is kept, ns."""
        return int(self.max_days * _DAY)


def prune_events(
    database: Database, limits: RetentionLimits, now: int, cutter: ChainCutter
) -> Iterator[int]:
    """Delete what is out of bounds at `now` (ns); yield how many events each time.

    Too many bytes take `counts` events first on SQLite, and the oldest first, also those that do
    not fit their chains. `cutter` says where chains begin now.
    """
    if not database.is_sqlite:
        yield from prune_partitions(database, limits.max_age, limits.max_bytes, now, cutter)
        return
    yield from _prune_old(database, now - limits.max_age, cutter)
    excess = _excess_count(database, limits.max_bytes)
    for condition in ("kind = 'counts'", "kind <> 'counts'"):
        for deleted in _prune_matching(database, condition, excess, cutter):
            excess -= deleted
            yield deleted


def used_bytes(session: Session) -> int:
    """Return what the events take on disk; with SQLite all that the file holds."""
    if session.get_bind().dialect.name == "sqlite":
        pages = "SELECT page_count - freelist_count FROM pragma_page_count, pragma_freelist_count"
        size = "SELECT page_size FROM pragma_page_size"
        return int(session.scalar(text(f"SELECT ({pages}) * ({size})")) or 0)
    connection = session.connection()
    numbers = partition_numbers(connection)
    return sum(partition_bytes(connection, number) for number in numbers)


def _prune_old(database: Database, cutoff: int, cutter: ChainCutter) -> Iterator[int]:
    """Delete what was stored before `cutoff` (ns); ids are in the order of storing."""
    ids, robots = [_BEFORE_ALL] * BATCH_EVENTS, set[int]()
    while len(ids) == BATCH_EVENTS:
        with database.session() as session:  # what is refused may be much: nobody waits meanwhile
            rows = session.execute(_oldest_events(ids[-1], robots)).all()
        ids = [id for id, stored in rows if stored < cutoff]
        with database.write_session() as session:
            refused = cut_chains(session, ids, cutter)
            _delete(session, [id for id in ids if id not in refused])
        robots.update(refused.values())
        yield len(ids) - len(refused)


def _oldest_events(after: int, refused_robots: Collection[int]) -> Select[int, int]:
    """Select the oldest events behind an id, of robots with refused chains only their counts."""
    query = select(EventRow.id, EventRow.stored).where(
        EventRow.id > after,
        or_(EventRow.robot_id.not_in(refused_robots), EventRow.kind == EventKind.COUNTS),
    )
    return query.order_by(EventRow.id).limit(BATCH_EVENTS)


def _prune_matching(
    database: Database, condition: str, max_events: int, cutter: ChainCutter
) -> Iterator[int]:
    """Delete the `max_events` oldest events that fit a condition."""
    query = select(EventRow.id).where(text(condition)).order_by(EventRow.id)
    ids = [0]
    while ids and max_events > 0:
        query_after = query.where(EventRow.id > ids[-1]).limit(min(BATCH_EVENTS, max_events))
        with database.write_session() as session:
            ids = list(session.scalars(query_after))
            cut_chains(session, ids, cutter)
            _delete(session, ids)
        max_events -= len(ids)
        yield len(ids)


def _delete(session: Session, ids: Sequence[int]) -> None:
    session.execute(delete(EventRow).where(EventRow.id.in_(ids)), execution_options=_NO_OBJECTS)


def _excess_count(database: Database, size: int) -> int:
    """Return how many events are too many."""
    with database.session() as session:
        used = used_bytes(session)
        if used <= size:
            return 0
        return int(_event_count(session) * (1 - _TARGET_SHARE * size / used))


def _event_count(session: Session) -> int:
    return session.scalar(select(func.count()).select_from(EventRow)) or 0
