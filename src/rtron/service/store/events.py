"""Events come in, each exactly once, and what they say about coordination nodes is kept."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Insert, Table, or_, select, update
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from rtron.service.domain.schemas import EventView
from rtron.service.store.chains import ChainEntry, append_entries, events_chain, lock_chains
from rtron.service.store.event_rows import event_content, event_row, event_view
from rtron.service.store.partitions.event_runs import EventKey, keep_unstored
from rtron.service.store.tables import CoordinationNodeRow, EventRow, RobotRow
from rtron.vocabulary import Decision, EventKind, GuardEvent, GuardEventLevel

_EVENTS: Table = EventRow.__table__  # type: ignore[assignment]  # a table, not a join
_KEY = (_EVENTS.c.robot_id, _EVENTS.c.run, _EVENTS.c.number)
_VIOLATING_DECISIONS = frozenset({Decision.DROP, Decision.MODIFY})


@dataclass(frozen=True, slots=True)
class EventBatch:
    """Checked events of one robot, in the order of their numbers."""

    robot_id: int
    robot_name: str
    events: Sequence[GuardEvent]


@dataclass(frozen=True, slots=True)
class StoredEvent:
    """An event that is stored now and was not before: the columns of its row."""

    robot: str
    row: Mapping[str, Any]

    @property
    def is_violation(self) -> bool:
        """Whether a coordination node has refused or changed something, or stops the robot."""
        kind = self.row["kind"]
        if kind == EventKind.VERDICT:
            return self.row["decision"] in _VIOLATING_DECISIONS
        blocks = kind == EventKind.RULE and self.row["level"] != GuardEventLevel.INFO
        return bool(blocks or kind == EventKind.STOP)

    def view(self) -> EventView:
        """Return it as the API says it."""
        return event_view(self.robot, self.row)


def add_events(session: Session, now: int, batches: Sequence[EventBatch]) -> Sequence[StoredEvent]:
    """Store what is not stored yet, at `now` (ns); return it in the order of storing."""
    rows = [event_row(batch.robot_id, now, event) for batch in batches for event in batch.events]
    if not rows:
        return ()
    if session.get_bind().dialect.name != "sqlite":  # which has one writer
        # Before the rows have ids: so those of a robot have the order of its chain.
        lock_chains(session, sorted({events_chain(batch.robot_name) for batch in batches}))
    by_key = {(each["robot_id"], each["run"], each["number"]): each for each in rows}
    returned = _insert(session, by_key)
    robots = {batch.robot_id: batch.robot_name for batch in batches}
    added = [
        StoredEvent(robots[key[0]], {"id": id, **by_key[tuple(key)]})
        for id, *key in sorted(returned)
    ]
    _chain_events(session, added)
    _store_violations(session, added)
    return added


def lost_events_by_robot(
    session: Session, robots: Collection[str] | None = None
) -> Mapping[str, int]:
    """Return how many events are known to be lost, by robot; of all, or of some."""
    query = select(RobotRow.name, EventRow.values).join_from(EventRow, RobotRow)
    if robots is not None:
        query = query.where(RobotRow.name.in_(robots))
    counts: dict[str, int] = {}
    for robot, values in session.execute(query.where(EventRow.kind == EventKind.LOST.value)):
        counts[robot] = counts.get(robot, 0) + lost_event_count(values)
    return counts


def lost_event_count(values: Mapping[str, Any]) -> int:
    """Return the number of events that an event of the kind `lost` reports; 0 if malformed."""
    events = values.get("events")
    return events if type(events) is int and 0 <= events < 1 << 53 else 0


def _insert(session: Session, rows: Mapping[EventKey, Any]) -> Iterable[Any]:
    """Store the rows that are not there already; return the id and the key of each of these."""
    insert: Insert = sqlite.insert(_EVENTS).on_conflict_do_nothing()
    if session.get_bind().dialect.name != "sqlite":
        insert, rows = postgresql.insert(_EVENTS), keep_unstored(session, rows)
    returning = insert.returning(_EVENTS.c.id, *_KEY)
    return session.execute(returning, list(rows.values())) if rows else ()


def _chain_events(session: Session, added: Sequence[StoredEvent]) -> None:
    """Append what is new to the chains of its robots; counts, which are statistics, are in none."""
    entries = [
        ChainEntry(events_chain(each.robot), each.row["id"], event_content(each.robot, each.row))
        for each in added
        if each.row["kind"] != EventKind.COUNTS
    ]
    if entries:
        append_entries(session, entries)


def _store_violations(session: Session, added: Sequence[StoredEvent]) -> None:
    """Keep the newest violation with its coordination node."""
    violations = [each for each in added if each.row["node"] and each.is_violation]
    newest = {(each.robot, each.row["node"]): each for each in violations}
    for violation in newest.values():
        _store_violation(session, violation)


def _store_violation(session: Session, violation: StoredEvent) -> None:
    """Keep it in the robot's current app, unless a newer one is there."""
    node, row = CoordinationNodeRow, violation.row
    app = select(RobotRow.app_id).where(RobotRow.id == row["robot_id"]).scalar_subquery()
    change = (
        update(node)
        .where(node.app_id == app, node.node == row["node"])
        .where(or_(node.triggered.is_(None), node.triggered <= row["at"]))
        .values(triggered=row["at"], violation=violation.view().model_dump(mode="json"))
    )
    session.execute(change, execution_options={"synchronize_session": False})
