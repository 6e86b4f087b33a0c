"""Events come in, each exactly once, and what they say about coordination nodes is kept.

What comes from a guard is a stranger's: texts are cut to their columns, values that are no JSON or
too long are left out. PostgreSQL takes no NUL in a text.
"""

import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Insert, Table, or_, select, update
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from rtron.errors import WireError
from rtron.service.domain.schemas import EventView
from rtron.service.store.chains import ChainEntry, append_entries, events_chain, lock_chains
from rtron.service.store.partitions.event_partitions import EventKey, keep_unstored
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


MAX_VALUES_LENGTH = 1 << 16
"""The longest `values` of an event, characters of JSON."""
MAX_RUN_LENGTH = 40
_MAX_INT64 = (1 << 63) - 1
_VIEW_COLUMNS = EventView.model_fields.keys() - {"robot"}
EVENT_CONTENT = (*sorted(_VIEW_COLUMNS - {"id"}), "run", "number", "stored")
"""The columns of an event that are in its chain, beside the name of its robot."""


def check_event(event: GuardEvent) -> None:
    """Raise WireError if an event's run, number, time or revision is out of range."""
    check_run(event.run)
    if not 0 < event.number <= _MAX_INT64:
        raise WireError(f"event {event.number}: they count from 1")
    if not (0 <= event.at <= _MAX_INT64 and 0 <= event.revision <= _MAX_INT64):
        raise WireError(f"event {event.number}: its time or revision is out of range")


def check_run(run: str) -> None:
    """Raise WireError for what is no life of a guard."""
    if not 0 < len(run) <= MAX_RUN_LENGTH or "\0" in run:
        raise WireError(f"a run has 1 to {MAX_RUN_LENGTH} characters")


def event_row(robot_id: int, now: int, event: GuardEvent) -> dict[str, Any]:
    """Return the row of a checked event that is stored at `now` (ns), without its id."""
    return {
        "robot_id": robot_id,
        "run": event.run,
        "number": event.number,
        "at": event.at,
        "stored": now,
        "kind": event.kind.value,
        "level": event.level.value,
        "node": _clean_text(event.node, 200),
        "topic": _clean_text(event.topic, 300),
        "flow": _clean_text(event.flow, 200),
        "publisher": _clean_text(event.publisher, 300),
        "policy": event.policy.value if event.policy else "",
        "decision": event.decision.value if event.decision else "",
        "reason": _clean_text(event.reason, 1000),
        "revision": event.revision,
        "values": _json_values(event.values) if event.values else {},
    }


def event_content(robot: str, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a chain has of a stored event: everything but its id."""
    return {"robot": robot, **{name: row[name] for name in EVENT_CONTENT}}


def event_view(robot: str, row: Mapping[str, Any]) -> EventView:
    """Return a stored event, with its id, as the API says it."""
    return EventView(robot=robot, **{name: row[name] for name in _VIEW_COLUMNS})


def _clean_text(text: str, max_length: int) -> str:
    return text[:max_length].replace("\0", "\ufffd")


def _json_values(values: Mapping[str, Any]) -> Mapping[str, Any]:
    try:
        written = json.dumps(values, allow_nan=False)
    except ValueError:
        return _json_values(_finite(values))
    return values if len(written) <= MAX_VALUES_LENGTH else {"left_out": len(written)}


def _finite(value: Any) -> Any:  # noqa: ANN401 - any JSON value
    """Return the value with null for what JSON cannot say: NaN and the infinities."""
    if isinstance(value, Mapping):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
