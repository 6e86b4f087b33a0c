"""What would have been in an incident: without the guard, or under another plan.

The recorded commands are played through the policies of the plan, or go to the base as they are,
and what comes out is compared with what went out.
"""

from bisect import bisect_right
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import cos, remainder, sin, tau
from typing import Any

from rtron.coherence import EffectivePlan
from rtron.errors import InputError, WireError
from rtron.guard.incidents.entries import Observed
from rtron.guard.replay.incident_player import IncidentPlayer, PlayedMessage
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.planning.plan_file.defaults import app_name
from rtron.planning.plan_file.loader import parse_plan
from rtron.planning.plan_file.writer import write_plan
from rtron.sources.bag.incident import IncidentFile, PassedMessage, RecordedDecision
from rtron.vocabulary import (
    SECOND,
    Alternative,
    Area,
    Comparison,
    Curve,
    IncidentAccount,
    NotedPose,
    Plan,
    Settings,
    Velocity,
)
from rtron.workflows.incidents import bounded_entries

HOLD = SECOND
"""How long a base goes on at most with its last command, ns: what is assumed of it."""
_SMALL = 0.005
"""A difference of speeds that nobody sees, m/s."""
_STEP = SECOND // 20
_SETTLE = SECOND // 100
"""When what went out for a message has gone out, ns after it came."""
_REST = Velocity((0.0,))
_STRANGER = "/unapproved"


def without_guard(account: IncidentAccount) -> Alternative:
    """Return what the base would have got of all that published, each message as it came."""
    outputs: dict[str, Curve] = {}
    for topic, found in account.topics.items():
        merged = (each for curve in found.commands.values() for each in curve)
        outputs[topic] = sorted(merged, key=lambda each: each[0])
    return Alternative(title="without the guard", outputs=outputs)


def recorded_plan(incident: IncidentFile) -> tuple[Plan, Settings]:
    """Return the plan and the settings of an incident, the plan checked as a file of it is.

    PlanError if it is none that a guard runs; the app may have any name.
    """
    plan, settings = incident.plan
    known = incident.definitions
    text = write_plan(replace(plan, app=app_name(plan.app)))
    return parse_plan(text, f"{incident.path}, its plan", known), settings


def as_planned(incident: IncidentFile) -> Alternative:
    """Return what the plan would have done before anybody changed its settings."""
    plan, _ = recorded_plan(incident)
    return under_plan(incident, plan, "with the settings as planned")


def under_former_settings(incident: IncidentFile) -> Alternative:
    """Return what the plan would have done under the settings before the last change.

    InputError if the guard has recorded no change.
    """
    plan, _ = recorded_plan(incident)
    former = incident.former_settings
    if former is None:
        help = "--as-planned asks for the plan without any settings"
        message = "the settings were not changed while the guard recorded"
        raise InputError(message, path=str(incident.path), help=help)
    title = f"under the settings before, revision {former.revision}"
    return under_plan(incident, EffectivePlan(plan, former).check(), title)


def as_it_was(incident: IncidentFile) -> Alternative:
    """Return what the plan would have done under the settings that were in force."""
    plan, settings = recorded_plan(incident)
    return under_plan(incident, EffectivePlan(plan, settings).check(), "as it was")


def under_plan(incident: IncidentFile, plan: Plan, title: str) -> Alternative:
    """Return what another plan would have done.

    InputError if the plan is for the other ROS or has leases, or the file is damaged.
    """
    header = incident.header
    if plan.ros != header.ros:
        message = f"the plan is for ROS {plan.ros}, the incident is of ROS {header.ros}"
        raise InputError(message, path=str(incident.path), help="choose another plan")
    if plan.leases:
        message = "the plan has leases, whose requests are not played"
        raise InputError(message, path=str(incident.path), help="--without-guard needs none")
    first = header.causes[0].at
    player = IncidentPlayer(replace(plan, cell=()), header.begin)
    try:
        player.play(_recording(incident), header.end)
    finally:
        player.close()
    outputs: dict[str, Curve] = {}
    reader = _VelocityReader(incident)
    for topic, messages in player.outputs.items():
        velocities = ((at - first, reader.read(topic, data)) for at, data in messages)
        outputs[topic] = [(at, each) for at, each in velocities if each is not None]
    return Alternative(title=title, outputs=outputs, notes=tuple(player.notes))


def plan_areas(incident: IncidentFile) -> tuple[Area, ...]:
    """Return the areas that the plan of an incident names."""
    plan, _ = recorded_plan(incident)
    return plan.msrcn.areas if plan.msrcn else ()


class _VelocityReader:
    """Reads the velocities of outputs, which are of their commands' types."""

    def __init__(self, incident: IncidentFile) -> None:
        self._readers = incident.velocity_readers()

    def read(self, topic: str, message: bytes) -> Velocity | None:
        reader = self._readers.get(topic)
        return reader(message) if reader else None


def _recording(incident: IncidentFile) -> Iterator[PlayedMessage | Observed]:
    """Yield the commands, and what was observed beside them."""
    stream_of = cache(_stream)
    for entry in bounded_entries(incident):
        if isinstance(entry, PassedMessage):
            if entry.flow:
                stream = stream_of(
                    entry.topic,
                    entry.publisher or _STRANGER,
                    entry.type,
                    entry.md5sum,
                    entry.definition,
                )
                yield PlayedMessage(entry.at, stream, entry.data)
        elif isinstance(entry, RecordedDecision) and entry.text("kind") == "observed":
            yield _observed(incident, entry)


def _stream(topic: str, publisher: str, type: str, md5sum: str, definition: str) -> RecordedStream:
    return RecordedStream(
        topic=topic, publisher=publisher, type=type, md5sum=md5sum, definition=definition
    )


def _observed(incident: IncidentFile, decision: RecordedDecision) -> Observed:
    at, document = decision.at, decision.document
    try:
        rates = tuple((str(each["id"]), *_rate(at, each)) for each in document["rates"])
        events = tuple((str(each["name"]), *_event(at, each)) for each in document["events"])
    except (KeyError, TypeError, ValueError, OverflowError, WireError):
        raise InputError(
            "what it says of frames and events is not as a guard writes it", path=str(incident.path)
        ) from None
    return Observed(at, rates, events)


def _rate(at: int, rate: dict[str, Any]) -> tuple[float, int]:
    age = rate["age"]
    return float(rate["fps"]), 0 if age is None else _time(at, age)


def _event(at: int, event: dict[str, Any]) -> tuple[int, int | None, bool | None, int | None, int]:
    newest, triggered, judged = event["newest"], event["triggered"], event["judged"]
    return (
        _count(event["publishers"]),
        None if newest is None else _time(at, newest),
        None if judged is None else bool(judged),
        None if triggered is None else _time(at, triggered),
        _count(event["true_count"]),
    )


def _time(at: int, age: object) -> int:
    """Return a time that a board can hold; ValueError if none can be meant."""
    if not isinstance(age, int) or not 0 <= at - age < 1 << 63:
        raise ValueError(age)
    return at - age


def _count(number: object) -> int:
    if not isinstance(number, int) or not 0 <= number < 1 << 31:
        raise ValueError(number)
    return number


def compare(
    account: IncidentAccount, alternative: Alternative, areas: Sequence[Area] = ()
) -> list[Comparison]:
    """Return how an alternative differs from what went out, by topic that has velocities.

    With poses in the incident, also which of these areas the robot would have come into.
    """
    found = []
    for topic, output in alternative.outputs.items():
        actual = account.topics[topic].output if topic in account.topics else []
        if output or actual:
            comparison = _comparison(topic, actual, output)
            found.append(replace(comparison, areas=_entered(account, comparison, output, areas)))
    return found


def _comparison(topic: str, actual: Curve, output: Curve) -> Comparison:
    """Compare where the speeds differ most, and how far the robot is driven."""
    now, then = SpeedCurve(actual), SpeedCurve(output)
    differences = _differences(actual, output)
    at = max(differences, key=differences.__getitem__)
    return Comparison(
        topic=topic,
        at=at,
        actual=now.speed(at + _SETTLE),
        alternative=then.speed(at + _SETTLE),
        differs_from=first_difference(actual, output),
        actual_way=now.way(),
        alternative_way=then.way(),
    )


def first_difference(actual: Curve, output: Curve) -> int | None:
    """Return when an output begins to differ from what went out (ns), None if it does not."""
    differing = (at for at, each in _differences(actual, output).items() if each > _SMALL)
    return min(differing, default=None)


def _differences(actual: Curve, output: Curve) -> dict[int, float]:
    """Return how much the speeds differ (m/s) at each message of the output."""
    now, then = SpeedCurve(actual), SpeedCurve(output)
    times = (at for at, _ in output or actual)
    return {at: abs(then.speed(at + _SETTLE) - now.speed(at + _SETTLE)) for at in times}


def _entered(
    account: IncidentAccount, comparison: Comparison, output: Curve, areas: Sequence[Area]
) -> tuple[tuple[str, int], ...]:
    """Return the areas that an alternative leads into and the robot was not in then."""
    since = comparison.differs_from
    poses = robot_poses(account, {area.frame for area in areas})
    if since is None or not poses:
        return ()
    path = alternative_path(poses, output, since)
    later = [(each.x, each.y) for each in poses if each.at >= since]
    found = []
    for area in areas:
        is_there = area.frame == poses[0].frame and not any(_is_in(area, *each) for each in later)
        when = next((at for at, x, y in path if is_there and _is_in(area, x, y)), None)
        if when is not None:
            found.append((area.name, when - since))
    return tuple(found)


def robot_poses(account: IncidentAccount, frames: Collection[str]) -> list[NotedPose]:
    """Return the poses of the topic in one of these frames that has most, or of any topic."""
    topics = [poses for poses in account.poses.values() if poses[0].frame in frames]
    return max(topics or account.poses.values(), key=len, default=[])


def alternative_path(
    poses: Sequence[NotedPose], output: Curve, since: int
) -> list[tuple[int, float, float]]:
    """Return where an alternative leads the robot from where it was at `since`: time, x, y (m)."""
    before = [each for each in poses if each.at <= since]
    start = before[-1] if before else poses[0]
    begun = SpeedCurve(output).since(since)
    return begun.path(start.x, start.y, start.yaw)


def _is_in(area: Area, x: float, y: float) -> bool:
    """Tell whether a place is in an area: a ray crosses its edges an odd number of times."""
    inside, corners = False, area.polygon
    for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
        if (start.y > y) != (end.y > y):
            crossing = start.x + (y - start.y) * (end.x - start.x) / (end.y - start.y)
            inside ^= x < crossing
    return inside


class SpeedCurve:
    """The speed that a base was asked for: each velocity holds until the next, or for `HOLD`."""

    def __init__(self, curve: Curve) -> None:
        self._times = [at for at, _ in curve]
        self._velocities = [each if each.is_finite else _REST for _, each in curve]

    def speed(self, at: int) -> float:
        """Return the speed at a time (ns), m/s."""
        index = bisect_right(self._times, at) - 1
        if index < 0 or at - self._times[index] > HOLD:
            return 0.0
        return self._velocities[index].speed

    def way(self) -> float:
        """Return how far a base is driven, m."""
        steps = zip(pairwise([*self._times, *self._last()]), self._velocities, strict=False)
        return sum(each.speed * min(b - a, HOLD) / SECOND for (a, b), each in steps)

    def since(self, at: int) -> "SpeedCurve":
        """Return the curve from a time (ns) on."""
        pairs = zip(self._times, self._velocities, strict=True)
        return SpeedCurve([each for each in pairs if each[0] >= at])

    def path(
        self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0
    ) -> list[tuple[int, float, float]]:
        """Return where a base is driven: time (ns), x, y, by dead reckoning, m.

        As a diff drive is: the first linear component is ahead, the second to the left, the last
        angular one the turn. A command is cut into steps of at most `_STEP`.
        """
        points = [(self._times[0], x, y)] if self._times else []
        steps = zip(pairwise([*self._times, *self._last()]), self._velocities, strict=False)
        for (begin, end), each in steps:
            until = min(end, begin + HOLD)
            ahead, side = (*each.linear, 0.0, 0.0)[:2]
            turn = each.angular[-1] if each.angular else 0.0
            for at in range(begin, until, _STEP):
                step = min(_STEP, until - at)
                duration = step / SECOND
                heading = yaw + turn * duration / 2
                x += (ahead * cos(heading) - side * sin(heading)) * duration
                y += (ahead * sin(heading) + side * cos(heading)) * duration
                yaw = remainder(yaw + turn * duration, tau)
                points.append((at + step, x, y))
        return points

    def _last(self) -> list[int]:
        return [self._times[-1] + HOLD] if self._times else []
