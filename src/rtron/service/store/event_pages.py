"""Stored events, newest first, a page at a time (keyset pagination by id)."""

from collections.abc import Iterator
from dataclasses import dataclass
from heapq import nlargest
from typing import Any

from sqlalchemy import ColumnElement, Select, func, select, text
from sqlalchemy.orm import Session

from rtron.service.domain.schemas import EventPage, EventView
from rtron.service.store.event_rows import view
from rtron.service.store.tables import EventRow, RobotRow
from rtron.vocabulary import EventKind, Level

MOST = 1000
"""The most events on one page."""
SPAN = 100_000
"""The most events that one page looks through."""
_LARGEST = (1 << 63) - 1
_COLUMNS = tuple(EventRow.__table__.columns)
_ABOVE = {Level.WARNING: ("warning", "error"), Level.ERROR: ("error",)}


@dataclass(frozen=True, slots=True, kw_only=True)
class EventFilter:
    """Which events: all that is given must fit.

    `level` is the least, `text` is looked for in the reasons without regard to case; `since` and
    `until` are times of the robot (ns, the latter excluded); `before` and `after` are ids. Without
    `counts` the figures of each second, which are most of the events, are left out.
    """

    robot: str | None = None
    kind: EventKind | None = None
    level: Level | None = None
    node: str | None = None
    topic: str | None = None
    text: str | None = None
    since: int | None = None
    until: int | None = None
    before: int | None = None
    after: int | None = None
    counts: bool = True


def event_page(session: Session, wanted: EventFilter, limit: int = 100) -> EventPage:
    """Return at most `limit` events, newest first; of robots nobody knows there are none.

    A page that no index serves looks through `SPAN` events at most: it may hold few events, or
    none, and yet have a `next`.
    """
    limit = max(1, min(limit, MOST))
    end = _searched(session, wanted)
    query = select(*_COLUMNS).where(EventRow.id >= end, *_conditions(wanted))
    query = query.order_by(EventRow.id.desc()).limit(limit + 1)
    found = nlargest(limit + 1, _of_each(session, wanted, query), key=_id)
    events = found[:limit]
    last = events[-1].id if len(found) > limit else end or None
    return EventPage(events=events, next=last)


def _searched(session: Session, wanted: EventFilter) -> int:
    """Return the id at which a page that no index serves stops to look; 0 if none is left out."""
    asked = (wanted.text, wanted.node, wanted.topic, wanted.since, wanted.until)
    if wanted.after is not None or not any(asked):
        return 0
    oldest, newest = session.execute(select(func.min(EventRow.id), func.max(EventRow.id))).one()
    if newest is None:
        return 0
    begin = newest + 1 if wanted.before is None else min(_long(wanted.before), newest + 1)
    return begin - SPAN if begin - SPAN > oldest else 0


def _of_each(session: Session, wanted: EventFilter, query: Select[Any]) -> Iterator[EventView]:
    """Yield the newest of each robot: so the indexes, which begin with the robot, serve all."""
    robots = select(RobotRow.id, RobotRow.name)
    if wanted.robot is not None:
        robots = robots.where(RobotRow.name == wanted.robot)
    for id, name in session.execute(robots).all():
        for row in session.execute(query.where(EventRow.robot_id == id)).mappings():
            yield view(name, row)  # type: ignore[arg-type]  # by the names of its columns


def _conditions(wanted: EventFilter) -> Iterator[ColumnElement[bool]]:
    for column, value in (
        (EventRow.kind, wanted.kind and wanted.kind.value),
        (EventRow.node, wanted.node),
        (EventRow.topic, wanted.topic),
    ):
        if value is not None:
            yield column == value
    if not wanted.counts:
        yield text("kind <> 'counts'")  # type: ignore[misc]  # as the index has it
    if wanted.level in _ABOVE:
        yield text("level <> 'info'")  # type: ignore[misc]  # as the index has it
        yield EventRow.level.in_(_ABOVE[wanted.level])
    if wanted.text:
        yield EventRow.reason.icontains(wanted.text, autoescape=True)
    yield from _bounds(wanted)


def _bounds(wanted: EventFilter) -> Iterator[ColumnElement[bool]]:
    if wanted.since is not None:
        yield EventRow.at >= _long(wanted.since)
    if wanted.until is not None:
        yield EventRow.at < _long(wanted.until)
    if wanted.before is not None:
        yield EventRow.id < _long(wanted.before)
    if wanted.after is not None:
        yield EventRow.id > _long(wanted.after)


def _long(value: int) -> int:
    """Return the nearest number that a database knows."""
    return max(-_LARGEST, min(value, _LARGEST))


def _id(event: EventView) -> int:
    return event.id
