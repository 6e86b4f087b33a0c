"""A Run: what a guard measured while it watched an app, in bounded figures, not message by message.

Durations are integer nanoseconds, speeds m/s, rates frames a second. A **phase** is a time in which
a flow speaks: it ends with a gap longer than ten times the usual one, and than a second. `gaps` are
those within phases, `pauses` those between them.
"""

from dataclasses import dataclass

from rtron.vocabulary.enums import Decision, Mode, PolicyName

RUN_SCHEMA = "rtron.run/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class DurationStatistics:
    """How long something took, ns: `count` times, the quantiles, and the longest.

    A quantile is never below the true one, and at most a tenth above it.
    """

    count: int = 0
    p50: int = 0
    p99: int = 0
    p999: int = 0
    max: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueStatistics:
    """How large something was: `count` times, the least, the quantiles, and the most."""

    count: int = 0
    min: float = 0.0
    p50: float = 0.0
    p99: float = 0.0
    p999: float = 0.0
    max: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RefusalStatistics:
    """How many messages a policy would have kept from passing as they were, and why the last."""

    policy: PolicyName
    decision: Decision
    count: int
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class OverlapStatistics:
    """For how long (ns) a flow spoke while another did."""

    flow: str
    duration: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FlowStatistics:
    """What one flow of a stream did.

    `active` (ns) is how long its phases lasted in all; `left_moving` counts those that ended with a
    velocity other than 0. `waits` are of messages that would have been held and then let go,
    `takes` the times from a goal to what says that it is done, `undone` the goals that nothing has
    said that of.
    """

    flow: str
    publisher: str
    messages: int = 0
    gaps: DurationStatistics = DurationStatistics()
    pauses: DurationStatistics = DurationStatistics()
    active: int = 0
    left_moving: int = 0
    waits: DurationStatistics = DurationStatistics()
    takes: DurationStatistics = DurationStatistics()
    undone: int = 0
    speeds: ValueStatistics = ValueStatistics()
    refusals: tuple[RefusalStatistics, ...] = ()
    overlaps: tuple[OverlapStatistics, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamStatistics:
    """What the flows of one stream did, and the nodes that spoke and are not in the plan.

    `per_frame` are the approved flows' speeds divided by the least frame rate of the moment: metres
    a frame. `unseen` counts the messages that came while an image node was silent.
    """

    topic: str
    mode: Mode
    flows: tuple[FlowStatistics, ...] = ()
    per_frame: ValueStatistics = ValueStatistics()
    unseen: int = 0
    strangers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class MonitorStatistics:
    """What an fps_monitor measured; `fps` leaves out the first window of every phase."""

    id: str
    frames: int = 0
    gaps: DurationStatistics = DurationStatistics()
    pauses: DurationStatistics = DurationStatistics()
    fps: ValueStatistics = ValueStatistics()


@dataclass(frozen=True, slots=True, kw_only=True)
class EventStatistics:
    """How often the event of an eflow came."""

    name: str
    messages: int = 0
    gaps: DurationStatistics = DurationStatistics()
    pauses: DurationStatistics = DurationStatistics()


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredRun:
    """A measured run of the app of a plan; it lasted `duration` (ns)."""

    app: str
    ros: int = 1
    duration: int = 0
    streams: tuple[StreamStatistics, ...] = ()
    monitors: tuple[MonitorStatistics, ...] = ()
    events: tuple[EventStatistics, ...] = ()
