"""The partitions of PostgreSQL's table of events: made beforehand, dropped as a whole.

A partition has a range of ids, which count up in the order of storing, so it is a span of time, by
whatever clock. To begin the next one, the sequence of ids jumps to the begin of its range; the low
half of an id goes on counting. Neither making nor dropping a partition makes a writer wait. An
INSERT finds only the partitions that were there when it began, so each is made one ahead.

No index of PostgreSQL is unique over partitions. So each run of a guard has a row with its highest
stored number, which whoever stores events of that run locks: what is above it is new, and what is
not is looked up.
"""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any, TypeVar

from sqlalchemy import Connection, Table, delete, func, select, text, tuple_
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from rtron.service.store.tables import EventRow, EventRunRow

ID_BITS = 32
"""So many low bits of an id are within its partition; JavaScript is exact up to 53 bits in all."""
_SIZE = 1 << ID_BITS
_RESERVE = 1 << 30
_NAME = re.compile(r"events_p([0-9]+)")
_CHILDREN = """SELECT child.relname FROM pg_inherits
    JOIN pg_class child ON child.oid = inhrelid
    WHERE inhparent = to_regclass('events') AND {condition} ORDER BY child.oid"""
_LEFT_BEHIND = """SELECT relname FROM pg_class
    WHERE relkind = 'r' AND NOT relispartition AND relname ~ '^events_p[0-9]+$'
    AND relnamespace = (SELECT relnamespace FROM pg_class WHERE oid = to_regclass('events'))"""


def partition_name(number: int) -> str:
    """Return the table of a partition."""
    return f"events_p{number}"


def id_range(number: int) -> tuple[int, int]:
    """Return the first id of a partition, and the first one behind it."""
    return number << ID_BITS, (number + 1) << ID_BITS


def stored_count(newest_id: int) -> int:
    """Return how many events have been stored in all, or since that count began again."""
    return newest_id % _SIZE


def partition_numbers(connection: Connection) -> Sequence[int]:
    """Return the partitions that there are, the oldest first."""
    return sorted(map(_number, _names(connection, _CHILDREN.format(condition="TRUE"))))


def current_partition(connection: Connection) -> int:
    """Return the partition that new events go into."""
    return _last_id(connection) >> ID_BITS


def is_nearly_full(connection: Connection) -> bool:
    """Tell whether the current partition has few ids left."""
    return stored_count(_last_id(connection)) > _SIZE - _RESERVE


def begin_partition(connection: Connection) -> int:
    """Let new events go into the next partition; return it. Nobody else may do so meanwhile."""
    number = current_partition(connection) + 1
    for each in {number, number + 1}.difference(partition_numbers(connection)):
        make_partition(connection, each)
    begin, _ = id_range(number)
    count = stored_count(_last_id(connection))
    first = begin + (count if count < _SIZE >> 1 else 0)
    connection.execute(text("SELECT setval('events_id_seq', :first)"), {"first": first})
    return number


def make_partition(connection: Connection, number: int) -> None:
    """Make a partition, in one statement, so that a crash leaves all of it or nothing."""
    name, (begin, end) = partition_name(number), id_range(number)
    connection.exec_driver_sql(f"""DO $$ BEGIN
        CREATE TABLE {name} (LIKE events INCLUDING DEFAULTS);
        ALTER TABLE events ATTACH PARTITION {name} FOR VALUES FROM ({begin}) TO ({end});
        END $$""")


def drop_partition(connection: Connection, number: int) -> None:
    """Drop a partition with all of its events."""
    name = partition_name(number)
    connection.exec_driver_sql(f"ALTER TABLE events DETACH PARTITION {name} CONCURRENTLY")
    connection.exec_driver_sql(f"DROP TABLE {name}")


def finish_dropping(connection: Connection) -> None:
    """Do what is left of a drop that was cut off."""
    for name in _names(connection, _CHILDREN.format(condition="inhdetachpending")):
        connection.exec_driver_sql(f"ALTER TABLE events DETACH PARTITION {name} FINALIZE")
    for name in _names(connection, _LEFT_BEHIND):
        connection.exec_driver_sql(f"DROP TABLE {name}")


def partition_bytes(connection: Connection, number: int) -> int:
    """Return what a partition takes on disk, with its indexes."""
    query = text("SELECT pg_total_relation_size(to_regclass(:name))")
    return int(connection.scalar(query, {"name": partition_name(number)}) or 0)


def event_count(connection: Connection, number: int) -> int:
    """Return how many events were stored in a partition, by their ids."""
    query = f"SELECT coalesce(max(id) - min(id) + 1, 0) FROM {partition_name(number)}"  # noqa: S608
    return int(connection.exec_driver_sql(query).scalar_one())


def newest_stored(connection: Connection, number: int) -> int | None:
    """Return when the newest event of a partition was stored (ns); None if it has none."""
    return _stored(connection, number, "DESC")


def oldest_stored(connection: Connection, number: int) -> int | None:
    """Return when the oldest event of a partition was stored (ns); None if it has none."""
    return _stored(connection, number, "ASC")


def _stored(connection: Connection, number: int, order: str) -> int | None:
    query = f"SELECT stored FROM {partition_name(number)} ORDER BY id {order} LIMIT 1"  # noqa: S608
    stored = connection.exec_driver_sql(query).scalar()
    return None if stored is None else int(stored)


def _last_id(connection: Connection) -> int:
    return int(connection.exec_driver_sql("SELECT last_value FROM events_id_seq").scalar_one())


def _names(connection: Connection, query: str) -> list[str]:
    return [str(name) for name in connection.exec_driver_sql(query).scalars()]


def _number(name: str) -> int:
    match = _NAME.fullmatch(name)
    if match is None:
        raise ValueError(f"{name} is no partition of events")
    return int(match[1])


EventKey = tuple[int, str, int]
"""What names an event: the id of its robot, the run of the guard, the number in it."""
Run = tuple[int, str]

_RUNS: Table = EventRunRow.__table__  # type: ignore[assignment]  # a table, not a join
_EVENTS: Table = EventRow.__table__  # type: ignore[assignment]  # likewise
_RUN = (_RUNS.c.robot_id, _RUNS.c.run)
_KEY = (_EVENTS.c.robot_id, _EVENTS.c.run, _EVENTS.c.number)
_NO_OBJECTS = {"synchronize_session": False}
_PAGE = 1000
_T = TypeVar("_T")


def keep_unstored(session: Session, events: Mapping[EventKey, _T]) -> dict[EventKey, _T]:
    """Return the events that are not stored; the session has to store them."""
    highest = _lock_runs(session, sorted({key[:2] for key in events}))
    doubtful = [key for key in events if key[2] <= highest[key[:2]]]
    stored = _find_stored(session, doubtful) if doubtful else frozenset()
    new = {key: event for key, event in events.items() if key not in stored}
    for robot_id, run, number in new:
        highest[robot_id, run] = max(number, highest[robot_id, run])
    if new:
        _store_highest(session, {key[:2]: highest[key[:2]] for key in new})
    return new


def forget_runs_without_events(session: Session) -> None:
    """Forget runs of which no event is left; those that somebody stores events of stay."""
    after: Run = (-1, "")
    while locked := _lock_page(session, after):
        after = locked[-1]
        with_events = select(EventRow.id).where(
            EventRow.robot_id == _RUNS.c.robot_id, EventRow.run == _RUNS.c.run
        )
        # A statement of its own: it sees what was committed before the rows were locked.
        forgotten = delete(_RUNS).where(tuple_(*_RUN).in_(locked), ~with_events.exists())
        session.execute(forgotten, execution_options=_NO_OBJECTS)


def _lock_page(session: Session, after: Run) -> Sequence[Run]:
    query = select(*_RUN).where(tuple_(*_RUN) > after).order_by(*_RUN).limit(_PAGE)
    rows = session.execute(query.with_for_update(skip_locked=True))
    return [(robot_id, run) for robot_id, run in rows]


def _lock_runs(session: Session, runs: Sequence[Run]) -> dict[Run, int]:
    """Return the highest stored number of each run, locked in one order for all; made if new."""
    found = _locked(session, runs)
    if len(found) < len(runs):
        new = [
            {"robot_id": id, "run": run, "number": 0} for id, run in runs if (id, run) not in found
        ]
        session.execute(insert(_RUNS).on_conflict_do_nothing(), new)
        found = _locked(session, runs)
    return found


def _locked(session: Session, runs: Sequence[Run]) -> dict[Run, int]:
    query = select(*_RUN, _RUNS.c.number).where(tuple_(*_RUN).in_(runs)).order_by(*_RUN)
    return {
        (robot_id, run): number
        for robot_id, run, number in session.execute(query.with_for_update())
    }


def _find_stored(session: Session, keys: Collection[EventKey]) -> frozenset[Any]:
    query = select(*_KEY).where(tuple_(*_KEY).in_(keys))
    return frozenset(tuple(row) for row in session.execute(query))


def _store_highest(session: Session, highest: Mapping[Run, int]) -> None:
    change = insert(_RUNS)
    number = func.greatest(change.excluded.number, _RUNS.c.number)
    change = change.on_conflict_do_update(index_elements=_RUN, set_={"number": number})
    rows = [{"robot_id": id, "run": run, "number": number} for (id, run), number in highest.items()]
    session.execute(change.returning(_RUNS.c.run), rows)
