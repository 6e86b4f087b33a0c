"""An incident: what a guard has saved of the minute before it intervened, and what that tells."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from rtron.vocabulary.velocity import Velocity

INCIDENT_SCHEMA = "rtron.incident/1"
"""The name and version of the JSON format."""
MOST_CHANGES = 10_000
_GRAVEST_FIRST = ("alarm", "stop", "intervention")
Curve: TypeAlias = list[tuple[int, Velocity]]
"""Velocities and when they passed (ns after the first cause)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentCause:
    """Why an incident was saved, at a time (ns, wall clock)."""

    at: int
    kind: Literal["intervention", "stop", "alarm"]
    topic: str
    flow: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentHeader:
    """What an incident is about: the first cause first, and the time it covers (ns, wall clock).

    `rtron` is the version, `distribution` that of ROS where it was sourced.
    """

    causes: tuple[IncidentCause, ...]
    omitted_causes: int
    begin: int
    end: int
    app: str
    ros: Literal[1, 2]
    revision: int
    rtron: str
    distribution: str = ""
    format: Literal[1] = 1

    @property
    def gravest(self) -> IncidentCause:
        """The first alarm, or else the first stop, or else the first intervention."""
        return min(self.causes, key=lambda cause: _GRAVEST_FIRST.index(cause.kind))


@dataclass(frozen=True, slots=True)
class NotedChange:
    """A decision on a flow that differs from the one before, `at` ns after the first cause."""

    at: int
    flow: str
    decision: str
    policy: str
    reason: str


@dataclass(frozen=True, slots=True)
class IncidentEvent:
    """An alarm, a rule, settings or a loss in an incident; `at` is ns after the first cause."""

    at: int
    kind: str
    topic: str
    reason: str


@dataclass(frozen=True, slots=True)
class NotedPose:
    """Where the robot was: a place on the ground of a frame (m) and a heading (rad).

    `at` is ns after the first cause.
    """

    at: int
    frame: str
    x: float
    y: float
    yaw: float


@dataclass(slots=True)
class TopicAccount:
    """What passed on one guarded topic in an incident, and what was decided about it.

    `owners` are who was in command, whose node that is, and why the robot was being stopped, each
    from a time on. `limits` are in m/s, None where there was none. Times are ns after the first
    cause.
    """

    commands: dict[str, Curve] = field(default_factory=dict)
    output: Curve = field(default_factory=list)
    limits: list[tuple[int, float | None]] = field(default_factory=list)
    publishers: dict[str, str] = field(default_factory=dict)
    verdicts: Counter[tuple[str, str]] = field(default_factory=Counter)
    changes: list[NotedChange] = field(default_factory=list)
    omitted_changes: int = 0
    owners: list[tuple[int, str, str, str]] = field(default_factory=list)
    _last: dict[str, tuple[str, str]] = field(default_factory=dict)

    def note_verdict(self, change: NotedChange) -> None:
        """Count a verdict, and keep it if it differs from the one before on its flow."""
        self.verdicts[change.flow, change.decision] += 1
        key = (change.decision, change.policy)
        if self._last.get(change.flow) == key:
            return
        self._last[change.flow] = key
        if len(self.changes) < MOST_CHANGES:
            self.changes.append(change)
        else:
            self.omitted_changes += 1

    def note_control(self, at: int, owner: tuple[str, str, str], limit: float | None) -> None:
        """Keep who is in command and what the limit is, where they change."""
        if not self.owners or self.owners[-1][1:] != owner:
            self.owners.append((at, *owner))
        if not self.limits or self.limits[-1][1] != limit:
            self.limits.append((at, limit))


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentAccount:
    """What an incident's file tells, by topic, and what happened beside the messages.

    `poses` are what topics of events said of where something is, of the robot most likely.
    """

    header: IncidentHeader
    topics: dict[str, TopicAccount]
    events: tuple[IncidentEvent, ...]
    poses: dict[str, list[NotedPose]] = field(default_factory=dict)

    @property
    def span(self) -> tuple[int, int]:
        """When it begins and ends, ns after the first cause."""
        first = self.header.causes[0].at
        return self.header.begin - first, self.header.end - first


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedIncident:
    """A file of a folder of incidents; `problem` says why it is not one that can be read."""

    name: str
    size: int
    header: IncidentHeader | None
    problem: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative:
    """What would have gone out in an incident, by topic, if something had been different."""

    title: str
    outputs: dict[str, Curve]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """How an alternative differs from what went out on a topic.

    `at` (ns after the first cause) is where the speeds differ most, `differs_from` where they first
    do. Speeds are in m/s, ways (how far the base is driven) in m. `areas` are those of the plan
    that the robot would have come into and was not in: names, and when (ns after `differs_from`).
    """

    topic: str
    at: int
    actual: float
    alternative: float
    differs_from: int | None
    actual_way: float
    alternative_way: float
    areas: tuple[tuple[str, int], ...] = ()
