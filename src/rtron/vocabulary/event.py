"""What a guard tells about itself: events that are kept, and its state at this moment.

Times are wall clock, integer ns since 1970. Transitions are told one by one; verdicts that repeat
are counted per flow and second (design section 7).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rtron.vocabulary.enums import CommanderRank, Decision, Mode, PolicyName, StringEnum


class AlarmKind(StringEnum):
    """What an alarm is about."""

    FOREIGN_PUBLISHER = "foreign publisher"
    UNREGISTERED_PUBLISHER = "ghost publisher"
    IMPOSTOR = "impostor"
    INTRUSION = "intrusion"
    DRIFT = "drift"
    UNREACHABLE = "unseen"
    UNREADABLE = "unreadable"
    UNDELIVERED = "undelivered"
    GUARD = "guard"
    AUDIT_LOG = "audit log"


@dataclass(frozen=True, slots=True, kw_only=True)
class Alarm:
    """What is wrong, where, and who does it as far as that is known.

    `node` is whom it concerns, `peer` the other end: a node's name or an address.
    """

    kind: AlarmKind
    reason: str
    topic: str = ""
    node: str = ""
    peer: str = ""


class EventKind(StringEnum):
    """What an event is about."""

    GUARD = "guard"
    OWNER = "owner"
    LEASE = "lease"
    VERDICT = "verdict"
    STOP = "stop"
    RULE = "rule"
    ALARM = "alarm"
    ALARM_CLEARED = "settled"
    OVERRIDE = "override"
    SETTINGS = "settings"
    COUNTS = "counts"
    LOST = "lost"


class GuardEventLevel(StringEnum):
    """How much an event asks for attention, least first."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardEvent:
    """One thing that happened in a guard; (`run`, `number`) names it for ever.

    `run` is one life of one guard, `number` counts its events from 1. `node` is the coordination
    node. `values` has, as JSON, what only some kinds have. Of `counts`, told for each second in
    which there was something: `{"streams": {topic: {"flows": {flow: [passed, held, dropped,
    modified]}, "speed": m/s or null, "limit": m/s or null, "latency": [mean, worst] in us or
    null, "lost": [before, behind the guard]}}, "fps": {fps_monitor: rate}}`. Of `alarm` and
    `settled` the alarm itself; of `lease` which one and who holds it now, as its status topic has
    it; of `lost` `{"events": n}`, the number of those that were dropped.
    """

    run: str
    number: int
    at: int
    kind: EventKind
    level: GuardEventLevel = GuardEventLevel.INFO
    node: str = ""
    topic: str = ""
    flow: str = ""
    publisher: str = ""
    policy: PolicyName | None = None
    decision: Decision | None = None
    reason: str = ""
    revision: int = 0
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictCounts:
    """How many messages of a flow met which verdict since the guard began.

    `lost` were sent and never met one: they did not reach the guard, or came too late.
    """

    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0
    lost: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaseStatus:
    """Who holds a lease, "" for nobody, since when and why, and until when without a renewal.

    `grant` is another number with each holder, 0 for nobody; `given_by` a person with the rank, ""
    if the holder has asked for it.
    """

    name: str
    holder: str = ""
    rank: CommanderRank | None = None
    since: int = 0
    until: int = 0
    reason: str = ""
    grant: int = 0
    given_by: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamState:
    """Who controls a guarded topic now, and why.

    `owner` is a flow, "" while idle; `stopping` says why the robot is being stopped. `speed` is of
    the last velocity that went out and `limit` what it may be, m/s. `latency` is how long messages
    took through the guard in the last second: mean and worst, us. `lost_behind` counts the messages
    that left the guard and did not reach a subscriber, as far as the middleware tells. `lease` says
    who holds the lease that the flows need, since when and why; "" if they need none.
    `lease_status` says the same for programs.
    """

    topic: str
    nodes: tuple[str, ...]
    mode: Mode
    owner: str = ""
    publisher: str = ""
    stopping: str = ""
    flows: Mapping[str, VerdictCounts] = field(default_factory=dict)
    strangers: Mapping[str, int] = field(default_factory=dict)
    speed: float | None = None
    limit: float | None = None
    latency: tuple[float, float] | None = None
    lost_behind: int = 0
    lease: str = ""
    lease_status: LeaseStatus | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleState:
    """A rule of the mission, whether it blocks now, and why."""

    name: str
    blocks: bool
    reason: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenRequest:
    """What a client of the bridge asks for, word for word, and a person must approve first.

    `digest` names it, with its content, for ever. Unanswered it ends at `until`.
    """

    number: int
    digest: str
    client: str
    what: str
    content: str
    until: int


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenRequests:
    """The requests of a bridge's clients that wait for a person: `count`, some of them `shown`.

    People at the service may answer who have one of `roles` there, or one of `names`.
    """

    count: int = 0
    shown: tuple[OpenRequest, ...] = ()
    roles: tuple[str, ...] = ()
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardState:
    """All of a guard at one moment.

    `fps` is by fps_monitor; `bits` are the eflows', None while nobody knows one. `lost_events` are
    the messages that eflows did not get, by topic. `requests` are of the app's bridge, which the
    link process asks; None if none answers.
    """

    at: int
    revision: int
    streams: tuple[StreamState, ...] = ()
    rules: tuple[RuleState, ...] = ()
    bits: Mapping[str, bool | None] = field(default_factory=dict)
    fps: Mapping[str, float] = field(default_factory=dict)
    lost_events: Mapping[str, int] = field(default_factory=dict)
    alarms: tuple[Alarm, ...] = ()
    overridden: tuple[str, ...] = ()
    stopped: bool = False
    requests: OpenRequests | None = None
