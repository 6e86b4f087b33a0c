"""The report of an incident: the file, which may be many megabytes, reduced to what people look at.

Names and reasons may be strangers': they are cut, and what could steer a page is written out.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import Literal

from rtron.errors import InputError
from rtron.sanitize import sanitize
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import (
    SECOND,
    Alternative,
    Area,
    Comparison,
    Curve,
    IncidentAccount,
    IncidentCause,
    IncidentEvent,
    NotedPose,
    TopicAccount,
)
from rtron.wire.common.incident_report import (
    MAX_AREAS,
    MAX_CAUSES,
    MAX_CHANGES,
    MAX_CORNERS,
    MAX_EVENTS,
    MAX_FLOWS,
    MAX_NOTES,
    MAX_NUMBER,
    MAX_OWNERS,
    MAX_PLACES,
    MAX_POINTS,
    MAX_SENTENCE,
    MAX_TEXT,
    MAX_TOPICS,
    IncidentReport,
    ReportedAlternative,
    ReportedArea,
    ReportedCause,
    ReportedChange,
    ReportedEvent,
    ReportedFlow,
    ReportedOwner,
    ReportedTopic,
)
from rtron.workflows.incidents import read_account
from rtron.workflows.what_if import (
    HOLD,
    SpeedCurve,
    alternative_path,
    compare,
    first_difference,
    plan_areas,
    robot_poses,
    under_former_settings,
    without_guard,
)

Sentence = Callable[[Comparison], str]
"""Puts how an alternative differs from what went out into words."""
_MILLI = 3
_NOTED_WITHIN = SECOND
_DECISIONS: tuple[Literal["pass", "hold", "drop", "modify"], ...] = (
    "pass",
    "hold",
    "drop",
    "modify",
)


def incident_report(incident: IncidentFile, sentence: Sentence) -> IncidentReport:
    """Return the report of an incident; InputError where the file is damaged."""
    account, areas = read_account(incident), plan_areas(incident)
    header, gravest = account.header, account.header.gravest
    names = _gravest_first(account)
    grid = _Grid.of(account)
    path, frame = _path(account, areas, names)
    owner, publisher = _in_command(account, gravest)
    return IncidentReport(
        name=incident.path.name,
        size=incident.path.stat().st_size,
        at=header.causes[0].at,
        app=_text(header.app),
        ros=header.ros,
        distribution=_text(header.distribution),
        rtron=_text(header.rtron),
        revision=header.revision,
        gravest=_cause(account, gravest),
        owner=owner,
        publisher=publisher,
        causes=tuple(_cause(account, each) for each in header.causes[:MAX_CAUSES]),
        omitted_causes=header.omitted_causes + max(0, len(header.causes) - MAX_CAUSES),
        begin=_seconds(grid.begin),
        step=grid.step / SECOND,
        topics=tuple(_topic(name, account.topics[name], grid) for name in names),
        omitted_topics=len(account.topics) - len(names),
        events=tuple(map(_event, account.events[:MAX_EVENTS])),
        omitted_events=max(0, len(account.events) - MAX_EVENTS),
        frame=_text(frame),
        path=_thinned(path),
        areas=tuple(_area(each) for each in areas if each.frame == frame)[:MAX_AREAS],
        alternatives=tuple(
            _alternative(each, account, (areas, names, grid), sentence)
            for each in _alternatives(incident, account)
        ),
    )


@dataclass(frozen=True, slots=True)
class _Grid:
    """The steps of a report's speeds: where they begin, and how long each is (ns)."""

    begin: int
    step: int

    @classmethod
    def of(cls, account: IncidentAccount) -> "_Grid":
        begin, end = account.span
        return cls(begin, max(1, -(-(end - begin) // MAX_POINTS)))

    def speeds(self, curve: Curve) -> tuple[float | None, ...]:
        """Return the fastest speed that began in each step, or else that of what still holds."""
        values: list[float | None] = [None] * MAX_POINTS
        end = self.begin + self.step * MAX_POINTS
        times = [*(at for at, _ in curve), end]
        for (at, until), (_, velocity) in zip(pairwise(times), curve, strict=True):
            if velocity.is_finite:
                self._fill(values, at, min(until, at + HOLD), velocity.speed)
        return tuple(values)

    def limits(self, limits: Sequence[tuple[int, float | None]]) -> tuple[float | None, ...]:
        """Return the limit at the end of each step."""
        values: list[float | None] = [None] * MAX_POINTS
        for at, limit in limits:
            value = None if limit is None else _number(limit)
            first = self._index(at)
            values[first:] = [value] * (MAX_POINTS - first)
        return tuple(values)

    def _fill(self, values: list[float | None], at: int, until: int, speed: float) -> None:
        first = self._index(at)
        values[first] = max(values[first] or 0.0, _number(speed))
        for index in range(first + 1, self._index(until)):
            values[index] = _number(speed)

    def _index(self, at: int) -> int:
        return max(0, min((at - self.begin) // self.step, MAX_POINTS - 1))


def _gravest_first(account: IncidentAccount) -> list[str]:
    """Return the topics to report: those of causes first, then those with velocities."""
    header = account.header
    causes = [header.gravest.topic, *(each.topic for each in header.causes)]
    moving = [name for name, each in account.topics.items() if each.commands or each.output]
    ordered = dict.fromkeys([*causes, *moving, *account.topics])
    return [name for name in ordered if name in account.topics][:MAX_TOPICS]


def _in_command(account: IncidentAccount, cause: IncidentCause) -> tuple[str, str]:
    """Return the flow in command of a cause's topic then, and its node.

    Who begins with a cause is noted in command a moment after it.
    """
    found = account.topics.get(cause.topic, TopicAccount())
    at = cause.at - account.header.causes[0].at
    before = [each for each in found.owners if each[0] <= at][-1:]
    after = [each for each in found.owners if at < each[0] <= at + _NOTED_WITHIN]
    owners = ((owner, publisher) for _, owner, publisher, _ in (*before, *after) if owner)
    owner, publisher = next(owners, ("", ""))
    return _text(owner), _text(publisher)


def _cause(account: IncidentAccount, cause: IncidentCause) -> ReportedCause:
    return ReportedCause(
        at=_seconds(cause.at - account.header.causes[0].at),
        kind=cause.kind,
        topic=_text(cause.topic),
        flow=_text(cause.flow),
        reason=_text(cause.reason),
    )


def _event(event: IncidentEvent) -> ReportedEvent:
    return ReportedEvent(
        at=_seconds(event.at),
        kind=_text(event.kind),
        topic=_text(event.topic),
        reason=_text(event.reason),
    )


def _topic(name: str, account: TopicAccount, grid: _Grid) -> ReportedTopic:
    changes = account.changes[:MAX_CHANGES]
    return ReportedTopic(
        topic=_text(name),
        flows=tuple(_flows(account, grid)),
        output=grid.speeds(account.output),
        limits=grid.limits(account.limits),
        owners=tuple(
            ReportedOwner(
                at=_seconds(at),
                owner=_text(owner),
                publisher=_text(publisher),
                stopping=_text(stopping),
            )
            for at, owner, publisher, stopping in account.owners[:MAX_OWNERS]
        ),
        changes=tuple(
            ReportedChange(
                at=_seconds(each.at),
                flow=_text(each.flow),
                decision=_text(each.decision),
                policy=_text(each.policy),
                reason=_text(each.reason),
            )
            for each in changes
        ),
        left_out=account.omitted_changes + len(account.changes) - len(changes),
    )


def _flows(account: TopicAccount, grid: _Grid) -> Iterator[ReportedFlow]:
    """Yield the flows of a topic, those first that were dropped or changed most."""
    refused = dict.fromkeys(account.publishers, 0)
    for (flow, decision), count in account.verdicts.items():
        refused[flow] = refused.get(flow, 0) + (count if decision != "pass" else 0)
    for flow in islice(sorted(refused, key=refused.__getitem__, reverse=True), MAX_FLOWS):
        yield ReportedFlow(
            flow=_text(flow),
            publisher=_text(account.publishers.get(flow, "")),
            verdicts={each: account.verdicts[flow, each] for each in _DECISIONS},
            speeds=grid.speeds(account.commands.get(flow, [])),
        )


def _alternatives(incident: IncidentFile, account: IncidentAccount) -> list[Alternative]:
    """Return what would have been without the guard, and under the settings before, if known."""
    found = [without_guard(account)]
    if incident.former_settings is not None:
        try:
            found.append(under_former_settings(incident))
        except InputError as error:
            title = "under the settings before"
            found.append(Alternative(title=title, outputs={}, notes=(error.reason,)))
    return found


def _alternative(
    alternative: Alternative,
    account: IncidentAccount,
    view: tuple[Sequence[Area], Sequence[str], _Grid],
    sentence: Sentence,
) -> ReportedAlternative:
    areas, names, grid = view
    comparisons = {each.topic: each for each in compare(account, alternative, areas)}
    outputs = {name: alternative.outputs[name] for name in names if name in comparisons}
    return ReportedAlternative(
        title=_text(alternative.title),
        sentences=tuple(_text(sentence(comparisons[name]), MAX_SENTENCE) for name in outputs),
        notes=tuple(map(_text, alternative.notes[:MAX_NOTES])),
        outputs={_text(name): grid.speeds(output) for name, output in outputs.items()},
        path=_thinned(_alternative_path(account, alternative, areas, names)),
    )


def _path(
    account: IncidentAccount, areas: Sequence[Area], names: Sequence[str]
) -> tuple[list[tuple[float, float]], str]:
    """Return where the robot was and in which frame; in none by dead reckoning of what went out."""
    if poses := _poses(account, areas):
        return [(each.x, each.y) for each in poses], poses[0].frame
    output = account.topics[names[0]].output if names else []
    return [(x, y) for _, x, y in SpeedCurve(output).path()], ""


def _alternative_path(
    account: IncidentAccount, alternative: Alternative, areas: Sequence[Area], names: Sequence[str]
) -> list[tuple[float, float]]:
    output = alternative.outputs.get(names[0], []) if names else []
    poses = _poses(account, areas)
    if not poses:
        return [(x, y) for _, x, y in SpeedCurve(output).path()]
    since = first_difference(account.topics[names[0]].output, output) if names else None
    if since is None:
        return []
    return [(x, y) for _, x, y in alternative_path(poses, output, since)]


def _poses(account: IncidentAccount, areas: Sequence[Area]) -> list[NotedPose]:
    return robot_poses(account, {area.frame for area in areas})


def _area(area: Area) -> ReportedArea:
    corners = _thinned([(each.x, each.y) for each in area.polygon], MAX_CORNERS)
    return ReportedArea(name=_text(area.name), polygon=corners)


def _thinned(
    places: Sequence[tuple[float, float]], most: int = MAX_PLACES
) -> tuple[tuple[float, float], ...]:
    """Return places, evenly chosen where there are too many, the last one always."""
    if len(places) > most:
        places = [places[index * (len(places) - 1) // (most - 1)] for index in range(most)]
    return tuple((_number(x), _number(y)) for x, y in places)


def _text(text: str, most: int = MAX_TEXT) -> str:
    return sanitize(text)[:most]


def _seconds(duration: int) -> float:
    return _number(duration / SECOND)


def _number(value: float) -> float:
    """Return a number that a report can hold; a robot cannot be farther or faster than that."""
    return round(max(-MAX_NUMBER, min(value, MAX_NUMBER)), _MILLI)
