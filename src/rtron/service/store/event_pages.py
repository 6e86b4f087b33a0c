"""Stored events, newest first, a page at a time (keyset pagination by id)."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from heapq import nlargest
from typing import Any

from sqlalchemy import ColumnElement, Select, select, text, true
from sqlalchemy.orm import Session

from rtron.service.domain.schemas import EventPage, EventView
from rtron.service.store.events import event_view
from rtron.service.store.tables import EventRow, RobotRow
from rtron.vocabulary import EventKind, GuardEventLevel

MAX_PAGE_EVENTS = 1000
"""The most events on one page."""
MAX_SEARCHED_EVENTS = 100_000
"""The most events that one page looks through."""
_ROBOT = "robot_name"
_MAX_INT64 = (1 << 63) - 1
_COLUMNS = tuple(EventRow.__table__.columns)
_LEVELS_FROM = {GuardEventLevel.WARNING: ("warning", "error"), GuardEventLevel.ERROR: ("error",)}


@dataclass(frozen=True, slots=True, kw_only=True)
class EventFilter:
    """Which events: all that is given must fit.

    `level` is the least, `text` is looked for in the reasons without regard to case; `since` and
    `until` are times of the robot (ns, the latter excluded); `before` and `after` are ids. Without
    `counts` the figures of each second, which are most of the events, are left out.
    """

    robot: str | None = None
    kind: EventKind | None = None
    level: GuardEventLevel | None = None
    node: str | None = None
    topic: str | None = None
    text: str | None = None
    since: int | None = None
    until: int | None = None
    before: int | None = None
    after: int | None = None
    counts: bool = True


def event_page(session: Session, event_filter: EventFilter, limit: int = 100) -> EventPage:
    """Return at most `limit` events, newest first; of robots nobody knows there are none.

    A page that no index serves looks through `MAX_SEARCHED_EVENTS` events at most: it may hold few
    events, or none, and yet have a `next`.
    """
    limit = max(1, min(limit, MAX_PAGE_EVENTS))
    end = _search_end(session, event_filter)
    query = select(*_COLUMNS).where(EventRow.id >= end, *_conditions(event_filter))
    query = query.order_by(EventRow.id.desc()).limit(limit + 1)
    candidates = nlargest(limit + 1, _newest_of_each_robot(session, event_filter, query), key=_id)
    events = candidates[:limit]
    last = events[-1].id if len(candidates) > limit else end or None
    return EventPage(events=events, next=last)


def find_events(session: Session, ids: Collection[int]) -> list[EventView]:
    """Return the events of these ids that there are, oldest first."""
    query = select(RobotRow.name, *_COLUMNS).join(RobotRow, RobotRow.id == EventRow.robot_id)
    rows = session.execute(query.where(EventRow.id.in_(ids)).order_by(EventRow.id)).mappings()
    return [event_view(row["name"], row) for row in rows]  # type: ignore[arg-type]  # as above


def _search_end(session: Session, event_filter: EventFilter) -> int:
    """Return the id at which a page that no index serves stops to look; 0 if none is left out."""
    unindexed = (
        event_filter.text,
        event_filter.node,
        event_filter.topic,
        event_filter.since,
        event_filter.until,
    )
    if event_filter.after is not None or not any(unindexed):
        return 0
    query = select(EventRow.id).order_by(EventRow.id.desc())
    if event_filter.before is not None:
        query = query.where(EventRow.id < _clamp_int64(event_filter.before))
    next_id = session.scalar(query.offset(MAX_SEARCHED_EVENTS).limit(1))
    return 0 if next_id is None else next_id + 1


def _newest_of_each_robot(
    session: Session, event_filter: EventFilter, query: Select[Any]
) -> Iterator[EventView]:
    """Yield the newest of each robot: so the indexes, which begin with the robot, serve all."""
    name = RobotRow.name.label(_ROBOT)
    is_meant = true() if event_filter.robot is None else RobotRow.name == event_filter.robot
    if session.get_bind().dialect.name != "sqlite":
        # One statement, which is planned once: that takes a while over many partitions.
        newest = query.where(EventRow.robot_id == RobotRow.id).lateral()
        rows = session.execute(select(name, *newest.c).join(newest, true()).where(is_meant))
        yield from (event_view(row[_ROBOT], row) for row in rows.mappings())  # type: ignore[arg-type]
        return
    for id, robot in session.execute(select(RobotRow.id, name).where(is_meant)).all():
        for row in session.execute(query.where(EventRow.robot_id == id)).mappings():
            yield event_view(robot, row)  # type: ignore[arg-type]  # by the names of its columns


def _conditions(event_filter: EventFilter) -> Iterator[ColumnElement[bool]]:
    for column, value in (
        (EventRow.kind, event_filter.kind and event_filter.kind.value),
        (EventRow.node, event_filter.node),
        (EventRow.topic, event_filter.topic),
    ):
        if value is not None:
            yield column == value
    if not event_filter.counts:
        yield text("kind <> 'counts'")  # type: ignore[misc]  # as the index has it
    if event_filter.level in _LEVELS_FROM:
        yield text("level <> 'info'")  # type: ignore[misc]  # as the index has it
        yield EventRow.level.in_(_LEVELS_FROM[event_filter.level])
    if event_filter.text:
        yield EventRow.reason.icontains(event_filter.text, autoescape=True)
    yield from _range_conditions(event_filter)


def _range_conditions(event_filter: EventFilter) -> Iterator[ColumnElement[bool]]:
    if event_filter.since is not None:
        yield EventRow.at >= _clamp_int64(event_filter.since)
    if event_filter.until is not None:
        yield EventRow.at < _clamp_int64(event_filter.until)
    if event_filter.before is not None:
        yield EventRow.id < _clamp_int64(event_filter.before)
    if event_filter.after is not None:
        yield EventRow.id > _clamp_int64(event_filter.after)


def _clamp_int64(value: int) -> int:
    """Return the nearest number that a database knows."""
    return max(-_MAX_INT64, min(value, _MAX_INT64))


def _id(event: EventView) -> int:
    return event.id
