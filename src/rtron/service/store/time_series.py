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
from rtron.vocabulary import SECOND

MAX_POINTS = 600
MAX_NAMES = 200
"""So many topics, flows and fps_monitors are told at a point; what is more is left out."""
_SECONDS_PER_POINT = 20
"""So many seconds of each point are read."""
FlowCounts = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class StreamCounts:
    """A stream in the time of a point.

    `flows` counts by flow what was passed, held, dropped and modified; `speed` is the highest and
    `limit` the lowest (m/s), `latency` the mean and the worst (us).
    """

    flows: dict[str, FlowCounts]
    speed: float | None = None
    limit: float | None = None
    latency: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class TimeSeriesPoint:
    """What happened from `at` (ns) on; `fps` is the lowest by fps_monitor."""

    at: int
    streams: dict[str, StreamCounts]
    fps: dict[str, float]


@dataclass(frozen=True, slots=True)
class TimeSeries:
    """Points in the order of time, `width` ns each; where nothing was counted there is none.

    With `every` above 1 only every so many seconds were read, and the counts are multiplied by it.
    """

    width: int
    every: int
    points: list[TimeSeriesPoint]


@dataclass(frozen=True, slots=True)
class _Counts:
    """The values of a `counts` event."""

    streams: dict[str, StreamCounts]
    fps: dict[str, float] = field(default_factory=dict)


_COUNTS = TypeAdapter(_Counts)


def robot_time_series(session: Session, robot: str, since: int, until: int) -> TimeSeries:
    """Return the figures of a robot from `since` to `until` (ns, excluded)."""
    seconds = max(1, -(-(until - since) // SECOND))
    width = -(-seconds // MAX_POINTS)
    every = -(-width // _SECONDS_PER_POINT)
    samples = _read_counts(session, _query(robot, since, until, every))
    grouped = groupby(samples, lambda each: (each[0] - since) // (width * SECOND))
    points = [
        _point(since + index * width * SECOND, [counts for _, counts in group], every)
        for index, group in grouped
    ]
    return TimeSeries(width * SECOND, every, points)


def _query(robot: str, since: int, until: int, every: int) -> Select[Any]:
    robot_id = select(RobotRow.id).where(RobotRow.name == robot).scalar_subquery()
    query = select(EventRow.at, EventRow.values).where(
        EventRow.robot_id == robot_id,
        text("kind = 'counts'"),  # as the index has it
        EventRow.at >= since,
        EventRow.at < until,
    )
    if every > 1:
        query = query.where(EventRow.at // SECOND % every == 0)
    return query.order_by(EventRow.at)


def _read_counts(session: Session, query: Select[Any]) -> Iterator[tuple[int, _Counts]]:
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


def _point(at: int, samples: Sequence[_Counts], every: int) -> TimeSeriesPoint:
    topics = _first_names(topic for counts in samples for topic in counts.streams)
    monitors = _first_names(name for counts in samples for name in counts.fps)
    by_topic = {
        topic: [each.streams[topic] for each in samples if topic in each.streams]
        for topic in topics
    }
    return TimeSeriesPoint(
        at,
        {topic: _stream(streams, every) for topic, streams in by_topic.items()},
        {name: min(each.fps[name] for each in samples if name in each.fps) for name in monitors},
    )


def _stream(samples: Sequence[StreamCounts], every: int) -> StreamCounts:
    names = _first_names(name for counts in samples for name in counts.flows)
    return StreamCounts(
        {
            name: _sum([each.flows[name] for each in samples if name in each.flows], every)
            for name in names
        },
        max((each.speed for each in samples if each.speed is not None), default=None),
        min((each.limit for each in samples if each.limit is not None), default=None),
        _latency([each.latency for each in samples if each.latency]),
    )


def _sum(samples: Sequence[FlowCounts], every: int) -> FlowCounts:
    passed, held, dropped, modified = (every * sum(column) for column in zip(*samples, strict=True))
    return passed, held, dropped, modified


def _latency(samples: Sequence[tuple[float, float]]) -> tuple[float, float] | None:
    return (
        (fmean(each[0] for each in samples), max(each[1] for each in samples)) if samples else None
    )


def _first_names(names: Iterable[str]) -> list[str]:
    return list(islice(dict.fromkeys(names), MAX_NAMES))
