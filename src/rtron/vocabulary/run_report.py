"""A Run: what a guard measured while it watched an app, in bounded figures, not message by message.

Durations are integer nanoseconds, speeds m/s, rates frames a second. A **phase** is a time in which
a flow speaks: it ends with a gap longer than ten times the usual one, and than a second. `gaps` are
those within phases, `pauses` those between them.
"""

from dataclasses import dataclass

from rtron.vocabulary.enums import Decision, Mode, PolicyName, StringEnum

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


REPLAY_SCHEMA = "rtron.replay/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayFlowCounts:
    """What would have become of a flow's messages.

    A held message counts again when it passes or is dropped.
    """

    flow: str
    publisher: str
    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayStreamCounts:
    """What would have become of a topic's messages; `stops` counts the stop waves."""

    topic: str
    nodes: tuple[str, ...]
    flows: tuple[ReplayFlowCounts, ...]
    stops: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionChange:
    """A change in what happens on a topic, `at` ns after the first recorded message."""

    at: int
    topic: str
    flow: str
    decision: str
    policy: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayReport:
    """A whole replay: counts, changes in the order of time, and what was not judged and why.

    `duration` is the recording's, ns; `messages` counts all that were read; `unseen` the changes
    beyond the most that are kept.
    """

    messages: int
    duration: int
    streams: tuple[ReplayStreamCounts, ...]
    changes: tuple[DecisionChange, ...]
    notes: tuple[str, ...] = ()
    unseen: int = 0


PROPOSALS_SCHEMA = "rtron.proposals/1"


class TuningProposalKind(StringEnum):
    """What follows from the figures.

    `change`: another value. `keep`: the value fits, or too little was seen to say more. `look`:
    something that no value mends, for a person to look at.
    """

    CHANGE = "change"
    KEEP = "keep"
    LOOK = "look"


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningProposal:
    """What to do with one value of a plan, and the figures behind it.

    `node` is the id of the coordination node, `flow` the flow where it is one's, `key` the key in
    the plan. `before` and `after` are values as the plan writes them, `samples` counts what was
    measured for it.
    """

    kind: TuningProposalKind
    node: str
    key: str
    why: str
    flow: str = ""
    before: str = ""
    after: str = ""
    samples: int = 0
