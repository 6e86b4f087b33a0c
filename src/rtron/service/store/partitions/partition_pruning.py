"""Retention on PostgreSQL: the next partition is begun in time, old ones are dropped as a whole.

One replica at a time does so. A crash leaves nothing half done: the chains first begin behind a
partition, signed, then it goes, and their links before that at last. A partition with events that
do not fit their chain is kept, unless there is too much.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from sqlalchemy import Connection, delete, select, text
from sqlalchemy.orm import Session

from rtron.service.store.chain_check import chain_links
from rtron.service.store.chain_pruning import ChainBegin, ChainCutter
from rtron.service.store.chains import EVENTS_PREFIX
from rtron.service.store.database import Database
from rtron.service.store.partitions.event_partitions import (
    begin_partition,
    current_partition,
    drop_partition,
    event_count,
    finish_dropping,
    forget_runs_without_events,
    id_range,
    is_nearly_full,
    newest_stored,
    oldest_stored,
    partition_bytes,
    partition_numbers,
)
from rtron.service.store.tables import ChainLinkRow, ChainRow

AGE_PARTS, SIZE_PARTS = 30, 20
"""A partition is this part of the time, or of the bytes, that events are kept."""
MIN_SPAN = 6 * 3600 * 1_000_000_000
"""A partition is at least so long (ns), unless it is large."""
_LOCK_KEY = 0x7274726F6F
"""Of PostgreSQL's advisory locks, ours: one replica at a time changes the partitions."""
_TIMEOUT_S = 60
_LOCK_TIMEOUT = "5s"
_NO_OBJECTS = {"synchronize_session": False}


def prune_partitions(
    database: Database, max_age: int, max_bytes: int, now: int, cutter: ChainCutter
) -> Iterator[int]:
    """Begin the next partition if it is time; drop old ones, and yield how many events each had.

    An event is kept for `max_age` (ns), and goes with its partition. The current partition and the
    one before stay: somebody may be about to store an event there.
    """
    with _exclusive(database) as connection:
        if connection is None:
            return
        finish_dropping(connection)
        if _is_due(connection, max_age, max_bytes, now):
            begin_partition(connection)
        for number, is_too_much in _droppable(connection, max_age, max_bytes, now).items():
            begins = _check_chains(database, number, cutter, is_too_much=is_too_much)
            if not is_too_much and any(begin.fault for begin in begins.values()):
                return
            yield _drop(database, connection, number, begins, cutter)


@contextmanager
def _exclusive(database: Database) -> Iterator[Connection | None]:
    """Give a connection while no other replica has one, None if another has."""
    with database.own_connection(_TIMEOUT_S) as connection:
        connection.exec_driver_sql(f"SET lock_timeout = '{_LOCK_TIMEOUT}'")
        query = text("SELECT pg_try_advisory_lock(:key)")
        yield connection if connection.scalar(query, {"key": _LOCK_KEY}) else None


def _is_due(connection: Connection, max_age: int, max_bytes: int, now: int) -> bool:
    current = current_partition(connection)
    oldest = oldest_stored(connection, current)
    if oldest is None:
        return False
    is_old = now - oldest >= max(MIN_SPAN, max_age // AGE_PARTS)
    is_large = partition_bytes(connection, current) >= max_bytes // SIZE_PARTS
    return is_old or is_large or is_nearly_full(connection)


def _droppable(
    connection: Connection, max_age: int, max_bytes: int, now: int
) -> Mapping[int, bool]:
    """Return the partitions that are too old, and which there is too much of, the oldest first."""
    numbers = partition_numbers(connection)
    sizes = {number: partition_bytes(connection, number) for number in numbers}
    excess, found = sum(sizes.values()) - max_bytes, {}
    for number in numbers:
        if number >= current_partition(connection) - 1:
            break
        newest = newest_stored(connection, number)
        if excess <= 0 and newest is not None and newest >= now - max_age:
            break
        found[number] = excess > 0
        excess -= sizes[number]
    return found


def _check_chains(
    database: Database, number: int, cutter: ChainCutter, *, is_too_much: bool
) -> Mapping[str, ChainBegin]:
    """Return how far the chains fit up to the end of a partition.

    Those that were refused before come first, since one that does not fit keeps the partition.
    """
    begins: dict[str, ChainBegin] = {}
    for name in _chain_names(database, cutter):
        with database.session() as session:
            begins[name] = _check_chain(session, name, id_range(number)[1], cutter)
        if begins[name].fault and not is_too_much:
            break
    return begins


def _chain_names(database: Database, cutter: ChainCutter) -> Sequence[str]:
    with database.session() as session:
        query = select(ChainRow.name).where(ChainRow.name.startswith(EVENTS_PREFIX))
        return sorted(session.scalars(query), key=lambda name: (name not in cutter.refused, name))


def _check_chain(session: Session, name: str, end: int, cutter: ChainCutter) -> ChainBegin:
    chain = session.scalars(select(ChainRow).where(ChainRow.name == name)).one()
    return cutter.check(chain, lambda begin: chain_links(session, chain, begin.number, end))


def _drop(
    database: Database,
    connection: Connection,
    number: int,
    begins: Mapping[str, ChainBegin],
    cutter: ChainCutter,
) -> int:
    with database.write_session() as session:
        cutter.store(session, begins)
    events = event_count(connection, number)
    drop_partition(connection, number)
    for name, begin in begins.items():
        with database.write_session() as session:
            _forget_links(session, name, begin)
    with database.write_session() as session:
        forget_runs_without_events(session)
    return events


def _forget_links(session: Session, chain: str, begin: ChainBegin) -> None:
    id = select(ChainRow.id).where(ChainRow.name == chain).scalar_subquery()
    link = ChainLinkRow
    session.execute(
        delete(link).where(link.chain_id == id, link.number <= begin.head.number),
        execution_options=_NO_OBJECTS,
    )
