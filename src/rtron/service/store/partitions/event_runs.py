"""Which events are stored already, over all partitions of PostgreSQL's table of events.

No index of PostgreSQL is unique over partitions. So each run of a guard has a row with its highest
stored number, which whoever stores events of that run locks: what is above it is new, and what is
not is looked up.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Any, TypeVar

from sqlalchemy import Table, delete, func, select, tuple_
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from rtron.service.store.tables import EventRow, EventRunRow

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
