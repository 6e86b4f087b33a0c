"""The Plan (`rtron.yaml`): coordination nodes, their flows and policies (paper section 5).

All durations are integer nanoseconds; the file gives seconds or a number with a unit. All other
quantities are floats in SI units: m, m/s, m/s2, rad, rad/s, rad/s2, and metres per frame.
"""

from dataclasses import dataclass

from rtron.vocabulary.enums import (
    CommanderRank,
    Domain,
    FrameSource,
    Mode,
    OnError,
    OnForeign,
    OnSilence,
    PolicyName,
    Sharing,
    StreamKind,
    WhenUnknown,
)

PLAN_SCHEMA = "rtron.plan/1"
SECOND = 1_000_000_000
UNAPPROVED = "unapproved"
LONGEST_STALL = SECOND // 10
"""How long (ns) a guard may give no sign of life on a busy machine, unless the plan allows more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Flow:
    """One publisher's way through a coordination node.

    `publisher` is a node name, or a pattern with `*` for anonymous names. A higher `priority`
    goes first. `timeout` (ns) is how long others wait for this flow (Priority_Queue) or how long
    its action may take (FIFO_Queue). `on_silence` is what happens when the flow has moved the robot
    and then says nothing for `silent_after` (ns), `on_error` when a message cannot be judged.
    `rank` is that of the publisher where the flow needs a lease.
    """

    name: str
    publisher: str
    priority: int = 0
    block: bool = False
    timeout: int | None = None
    silent_after: int = SECOND // 2
    on_silence: OnSilence = OnSilence.STOP
    on_error: OnError = OnError.STOP
    rank: CommanderRank = CommanderRank.AGENT


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchedFlow:
    """A flow that is only read: an image node's frames (`iflow`), or a camera's."""

    name: str
    topic: str
    publisher: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EventFlow:
    """An event (`eflow`) and what sets its bit (paper section 5.3).

    `when` is an expression over the fields of `event`: the bit is 1 while it holds for the newest
    message, which counts for `max_age` (ns). With `present` (ns) the bit is 1 for that time after
    a message for which `when` holds; with `silent` (ns) it is 1 when there was none for that time.
    Without `when` every message counts. `frame` is the frame that positions are compared in.
    `on_silence`: nobody knows the bit, since the newest message is too old, none ever came, or the
    publisher is gone; `on_error`: the newest message cannot be judged.
    """

    name: str
    topic: str
    publisher: str
    type: str = ""
    when: str = ""
    present: int | None = None
    silent: int | None = None
    max_age: int = 2 * SECOND
    frame: str = ""
    on_silence: WhenUnknown = WhenUnknown.BLOCK
    on_error: WhenUnknown = WhenUnknown.BLOCK


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardedTopic:
    """A topic whose flows (`vflow`, `aflow`) the RSRCN or MSRCN lets pass or blocks.

    `uses` are the components of a Twist that the base obeys: the others are set to 0. Without it
    the base obeys all.
    """

    topic: str
    type: str
    flows: tuple[Flow, ...]
    successors: tuple[str, ...] = ()
    uses: tuple[str, ...] = ()


MAX_QUEUE_BYTES = 1 << 26
"""The most that waits in one queue of the guard, bytes; a single message may be larger."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GRCN:
    """A general risk coordination node: the publishers of one topic, before its successors.

    `release_after` (ns): silence after which a flow gives up the output (Preemption).
    `max_age` (ns): a queued message older than this is dropped. `max_hold` (ns): the longest that
    one action may hold the output. `done`: a topic whose message ends the action in progress, or an
    action of ROS 2 that goals without an id become.
    `queue_size`: messages kept for a waiting flow or a slow subscriber. `uses` are the components
    of a Twist that the base obeys: the others are set to 0. Without it the base obeys all. `lease`
    is the name of the lease that the flows need (Lease).
    """

    id: str
    topic: str
    type: str
    domain: Domain
    kind: StreamKind
    sharing: Sharing
    mode: Mode
    policy: PolicyName
    flows: tuple[Flow, ...]
    successors: tuple[str, ...] = ()
    release_after: int = SECOND // 2
    max_age: int = SECOND // 2
    max_hold: int = 600 * SECOND
    queue_size: int = 100
    done: str | None = None
    block_unapproved: bool = True
    uses: tuple[str, ...] = ()
    lease: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaseGroup:
    """A lease, shared by the GRCNs that name it; it holds for `ttl` (ns) unless it is renewed.

    `service` is the rank of persons at the security service; None: they only look.
    """

    name: str
    ttl: int = 5 * SECOND
    service: CommanderRank | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StopButton:
    """A button that stops the robot: `publisher` says on `topic` whether it is pressed (Bool).

    With `silent_after` (ns) the robot is stopped, too, while it has said nothing for that time.
    """

    name: str
    topic: str
    publisher: str
    silent_after: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StopSources:
    """What stops the robot until persons release it, beside a person on the robot.

    With `second_person` (ns) another person must release each stop, too, within that time.
    """

    buttons: tuple[StopButton, ...] = ()
    second_person: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FpsMonitor:
    """Measures the frame rate of one image node on the topic it publishes per frame.

    The rate is that of the last `window` (ns), and no higher than the `camera`'s; a node that is
    silent for `silent_after` (ns) has none.
    """

    id: str
    node: str
    topic: str
    source: FrameSource = FrameSource.FRAMES
    window: int = SECOND
    silent_after: int = SECOND
    camera: WatchedFlow | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RSRCN:
    """The robot-specific risk coordination node: one an app, before the users of max velocity.

    Safe: the velocity is at most `threshold` (metres per frame) times the least frame rate of the
    fps_monitors, and `lowest` (m/s) where one is silent. Constrain: at most `max_vel_limit` (m/s).
    Under each of them, where they are set: `max_turn_limit` (rad/s) for turning, `max_side_limit`
    (m/s) for driving sideways, `max_accel_limit` (m/s2) for how fast the speed rises.
    `mandatory`: a policy that the end user cannot deselect (paper section 6.3); if it limits by
    `max_vel_limit`, that limit can be lowered only.
    """

    id: str
    mode: Mode
    policy: PolicyName
    threshold: float | None = None
    max_vel_limit: float | None = None
    max_turn_limit: float | None = None
    max_side_limit: float | None = None
    max_accel_limit: float | None = None
    lowest: float = 0.0
    mandatory: PolicyName | None = None
    vflows: tuple[GuardedTopic, ...] = ()
    iflows: tuple[WatchedFlow, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """A place on the ground, in metres."""

    x: float
    y: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A named polygon in a frame; expressions call it by its name."""

    name: str
    frame: str
    polygon: tuple[Point, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform:
    """Where the frame `source` lies in the frame `target`: first turned by `yaw`, then moved."""

    source: str
    target: str
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionRule:
    """What the robot must not do, and when (paper section 4.3, table of examples).

    `when` is any boolean combination of eflow names. While it holds, the aflows that `block` names,
    or the topics, are blocked; with `action`, an expression over the fields of `action`, only the
    messages for which that holds, too. `require` makes an obligation of it: the block ends when
    the flow or the topic that it names has spoken. `frame` is the frame of the action's positions.
    A `mandatory` rule cannot be deselected or weakened by the end user.
    """

    name: str
    block: tuple[str, ...]
    when: str = "true"
    action: str = ""
    frame: str = ""
    require: str = ""
    reason: str = ""
    mandatory: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class MSRCN:
    """The mission-specific risk coordination node: one an app, before the actuator drivers."""

    id: str
    mode: Mode
    policy: PolicyName
    aflows: tuple[GuardedTopic, ...] = ()
    eflows: tuple[EventFlow, ...] = ()
    rules: tuple[MissionRule, ...] = ()
    areas: tuple[Area, ...] = ()
    transforms: tuple[Transform, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class StopProfile:
    """How the guard stops the robot: a ramp down, then zeros for a while, then nothing.

    `decel` (m/s2) and `angular_decel` (rad/s2) are the steepest ramp, unless it would take longer
    than `within` (ns): then every part is at rest. `period` (ns) is the time between its messages,
    `repeat` (ns) how long zeros are sent: one each period, later if the machine stands still.
    """

    decel: float = 2.5
    angular_decel: float = 3.2
    within: int = SECOND
    period: int = SECOND // 20
    repeat: int = SECOND


@dataclass(frozen=True, slots=True, kw_only=True)
class Audit:
    """How the guard watches that it is really in the way (design section 4).

    Every `period` (ns) each guarded node is asked who speaks to it. `on_foreign`: somebody does
    whom the plan does not name there.
    """

    period: int = 3 * SECOND // 40
    on_foreign: OnForeign = OnForeign.STOP


@dataclass(frozen=True, slots=True, kw_only=True)
class Supervision:
    """How long the guard may give no sign of life before its supervisor acts.

    After `stall_after` (ns) the robot is stopped, after `kill_after` (ns) the guard is killed and
    the next one begins. It is stopped, too, while nothing that goes into the guard comes out of it
    again within `deliver_within` (ns), and a stream is after which the audit has not looked for
    `audit_within` (ns). A guard may take `start_within` (ns) until its topics are open.
    """

    stall_after: int = 30 * SECOND // 1000
    kill_after: int = SECOND
    deliver_within: int = SECOND // 2
    audit_within: int = 10 * SECOND
    start_within: int = 20 * SECOND


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentRecording:
    """What the guard keeps on disk of what it does.

    The last `keep` (ns, 0: nothing) are in a ring. What has to be explained is saved with what came
    within `after` (ns) of its cause. Ring and incidents take `megabytes` at most.
    """

    keep: int = 60 * SECOND
    after: int = 5 * SECOND
    megabytes: int = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageDefinition:
    """A message type that RTron does not know: its definition, as `rosmsg show -r` writes it.

    For ROS 2, of an action too, it is the text of the type's file. Other types that it names follow
    after lines of `=` and `MSG: pkg/Name`.
    """

    type: str
    definition: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UnguardedPath:
    """A way to move the robot that the guard does not stand in."""

    what: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What stands between whom in the guarded app, and under which policies.

    `accept_unenforceable` names what cannot be reached and was accepted by the developer, as the
    plan's reader reported it. `cell` names the nodes that only the guard reaches, each in a network
    of its own. `revision` counts the settings. `unguarded` tells what else moves the robot.
    """

    app: str
    ros: int = 1
    revision: int = 0
    grcn: tuple[GRCN, ...] = ()
    rsrcn: RSRCN | None = None
    msrcn: MSRCN | None = None
    fps_monitor: tuple[FpsMonitor, ...] = ()
    leases: tuple[LeaseGroup, ...] = ()
    stop_sources: StopSources = StopSources()
    stop: StopProfile = StopProfile()
    audit: Audit = Audit()
    supervision: Supervision = Supervision()
    incidents: IncidentRecording = IncidentRecording()
    messages: tuple[MessageDefinition, ...] = ()
    cell: tuple[str, ...] = ()
    unguarded: tuple[UnguardedPath, ...] = ()
    accept_unenforceable: tuple[str, ...] = ()
