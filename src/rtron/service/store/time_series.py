"""What the streams of a robot did over time, for charts: its `counts` events, thinned."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby, islice
from statistics import fmean
from typing import Any

from pydantic import TypeAdapter, ValidationError
from sqlalchemy import Select, select, text
from sqlalchemy.orm import Session

from rtron.service.store.tables import EventRow, RobotRow

MOST_POINTS = 600
MOST_NAMES = 200
"""So many topics, flows and fps_monitors are told at a point; what is more is left out."""
_SECOND = 1_000_000_000
_READ = 20
"""So many seconds of each point are read."""
Tally = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class StreamCounts:
    """A stream in the time of a point.

    `flows` counts by flow what was passed, held, dropped and modified; `speed` is the highest and
    `limit` the lowest (m/s), `latency` the mean and the worst (us).
    """

    flows: dict[str, Tally]
    speed: float | None = None
    limit: float | None = None
    latency: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Point:
    """What happened from `at` (ns) on; `fps` is the lowest by fps_monitor."""

    at: int
    streams: dict[str, StreamCounts]
    fps: dict[str, float]


@dataclass(frozen=True, slots=True)
class Figures:
    """Points in the order of time, `width` ns each; where nothing was counted there is none.

    With `every` above 1 only every so many seconds were read, and the counts are multiplied by it.
    """

    width: int
    every: int
    points: list[Point]


@dataclass(frozen=True, slots=True)
class _Counts:
    """The values of a `counts` event."""

    streams: dict[str, StreamCounts]
    fps: dict[str, float] = field(default_factory=dict)


_COUNTS = TypeAdapter(_Counts)


def figures(session: Session, robot: str, since: int, until: int) -> Figures:
    """Return the figures of a robot from `since` to `until` (ns, excluded)."""
    seconds = max(1, -(-(until - since) // _SECOND))
    width = -(-seconds // MOST_POINTS)
    every = -(-width // _READ)
    read = _read(session, _query(robot, since, until, every))
    grouped = groupby(read, lambda each: (each[0] - since) // (width * _SECOND))
    points = [
        _point(since + place * width * _SECOND, [counts for _, counts in group], every)
        for place, group in grouped
    ]
    return Figures(width * _SECOND, every, points)


def _query(robot: str, since: int, until: int, every: int) -> Select[Any]:
    known = select(RobotRow.id).where(RobotRow.name == robot).scalar_subquery()
    query = select(EventRow.at, EventRow.values).where(
        EventRow.robot_id == known,
        text("kind = 'counts'"),  # as the index has it
        EventRow.at >= since,
        EventRow.at < until,
    )
    if every > 1:
        query = query.where(EventRow.at // _SECOND % every == 0)
    return query.order_by(EventRow.at)


def _read(session: Session, query: Select[Any]) -> Iterator[tuple[int, _Counts]]:
    for at, values in session.execute(query.execution_options(yield_per=500)):
        counts = _counts(values)
        if counts:
            yield at, counts


def _counts(values: Mapping[str, Any]) -> _Counts | None:
    """Return what an event counts, None if it is malformed: a guard may say anything."""
    try:
        return _COUNTS.validate_python(values)
    except ValidationError:
        return None


def _point(at: int, read: Sequence[_Counts], every: int) -> Point:
    topics = _first(topic for counts in read for topic in counts.streams)
    monitors = _first(name for counts in read for name in counts.fps)
    by_topic = {
        topic: [each.streams[topic] for each in read if topic in each.streams] for topic in topics
    }
    return Point(
        at,
        {topic: _stream(found, every) for topic, found in by_topic.items()},
        {name: min(each.fps[name] for each in read if name in each.fps) for name in monitors},
    )


def _stream(read: Sequence[StreamCounts], every: int) -> StreamCounts:
    names = _first(name for counts in read for name in counts.flows)
    return StreamCounts(
        {
            name: _sum([each.flows[name] for each in read if name in each.flows], every)
            for name in names
        },
        max((each.speed for each in read if each.speed is not None), default=None),
        min((each.limit for each in read if each.limit is not None), default=None),
        _latency([each.latency for each in read if each.latency]),
    )


def _sum(read: Sequence[Tally], every: int) -> Tally:
    passed, held, dropped, modified = (every * sum(column) for column in zip(*read, strict=True))
    return passed, held, dropped, modified


def _latency(read: Sequence[tuple[float, float]]) -> tuple[float, float] | None:
    return (fmean(each[0] for each in read), max(each[1] for each in read)) if read else None


def _first(names: Iterable[str]) -> list[str]:
    return list(islice(dict.fromkeys(names), MOST_NAMES))
