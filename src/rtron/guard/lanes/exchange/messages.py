"""What the two processes of the guard say to each other."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rtron.guard.core.report_messages import Status
from rtron.guard.lanes.exchange.lane_state import LaneState
from rtron.vocabulary import Alarm, EventKind, GuardEventLevel, Settings

MAX_ALARMS = 256
"""How many alarms are told that stop streams, and how many that stop nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodesReport:
    """The nodes of the command process in the graph.

    ROS 1: the `uris` of its nodes, their TCPROS `port`, and who has subscribed each private
    output. ROS 2: its `participant`, the first bytes of the GIDs, the supervisor's, and the
    `former_participants` of processes of the guard that have ended.
    """

    uris: Mapping[str, str] = field(default_factory=dict)
    port: int = 0
    subscribers: Mapping[str, frozenset[str]] = field(default_factory=dict)
    participant: bytes = b""
    former_participants: frozenset[bytes] = frozenset()
    supervisor_participant: bytes = b""


@dataclass(frozen=True, slots=True)
class BulkParticipant:
    """The participant of the bulk process (ROS 2)."""

    participant: bytes


@dataclass(frozen=True, slots=True)
class StatusReport:
    """The state of the streams for the diagnostics, once a second."""

    statuses: tuple[Status, ...]


@dataclass(frozen=True, slots=True)
class StateChange:
    """The state of the streams for the service."""

    state: LaneState


@dataclass(frozen=True, slots=True)
class Figures:
    """What became of the messages since the last figures, by topic."""

    by_topic: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An event `at` a time (ns, wall clock): `values` are the other fields of a GuardEvent."""

    at: int
    kind: EventKind
    level: GuardEventLevel
    values: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class AlarmChange:
    """An alarm was raised in the command process, or cleared there."""

    alarm: Alarm
    active: bool


@dataclass(frozen=True, slots=True)
class NewListener:
    """A node has begun to hear a private output."""

    topic: str
    node: str


@dataclass(frozen=True, slots=True)
class LostListener:
    """A node hears a private output no more."""

    topic: str
    node: str


@dataclass(frozen=True, slots=True)
class ShutdownRequest:
    """Somebody told a node of the command process to shut down (ROS 1)."""

    node: str
    reason: str


@dataclass(frozen=True, slots=True)
class SettingsAnswer:
    """Why settings could not be put in force, or nothing."""

    revision: int
    error: str


@dataclass(frozen=True, slots=True)
class BoardChanged:
    """An event's record on the board has changed."""


@dataclass(frozen=True, slots=True)
class ApplySettings:
    """Put settings in force, and answer."""

    settings: Settings


@dataclass(frozen=True, slots=True)
class HoldStream:
    """Let nothing of a stream pass and keep the robot stopped."""

    topic: str
    reason: str


@dataclass(frozen=True, slots=True)
class ReleaseStream:
    """Let pass again what the policies let pass."""

    topic: str


@dataclass(frozen=True, slots=True)
class RepeatStop:
    """Tell a stop to a node that has just begun to listen; either process asks the other."""

    topic: str


@dataclass(frozen=True, slots=True)
class RegisterNode:
    """Register a node again: somebody else has taken its name (ROS 1)."""

    name: str


@dataclass(frozen=True, slots=True)
class RaiseAlarm:
    """The audit has found something; the `streams` are stopped until a person clears them."""

    alarm: Alarm
    streams: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SettleAlarm:
    """The cause of an alarm is gone."""

    alarm: Alarm


@dataclass(frozen=True, slots=True)
class WithdrawAlarm:
    """An alarm was mistaken."""

    alarm: Alarm


@dataclass(frozen=True, slots=True)
class ActiveAlarms:
    """All that the audit has found and that is still there; what is not here is gone."""

    alarms: tuple[RaiseAlarm, ...]


@dataclass(frozen=True, slots=True)
class AuditProgress:
    """What the audit has not looked at yet; `ActiveAlarms` follows when nothing is missing."""

    missing: str


@dataclass(frozen=True, slots=True)
class AuditRound:
    """The audit has looked after all streams since the last round, but for the `unseen`: why."""

    unseen: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class StoppedStreams:
    """The streams that intruders have stopped and nobody has cleared."""

    topics: frozenset[str]


@dataclass(frozen=True, slots=True)
class DismissRequest:
    """Take the silent intruders of a stream for gone, and answer with this number."""

    number: int
    topic: str
    is_audible: bool


@dataclass(frozen=True, slots=True)
class DismissAnswer:
    """Why the intruders are not taken for gone, or nothing."""

    number: int
    refusal: str


@dataclass(frozen=True, slots=True)
class IntruderReturned:
    """An intruder that was taken for gone speaks (ROS 2)."""

    gid: bytes
