"""Settings, robots and events as the HTTP API has them; the console uses nothing else.

Times are wall clock, ns; durations that people give are seconds. Unknown keys of a request are
refused.
"""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from rtron.service.domain.roles import Right
from rtron.vocabulary import (
    EmergencyStop,
    EventKind,
    GuardEventLevel,
    GuardState,
    NodeSettings,
    Settings,
    StringEnum,
    TimedOverride,
)

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.@-]{0,99}$")]
Reason = Annotated[str, StringConstraints(strip_whitespace=True, max_length=200)]


class SettingsOutcome(StringEnum):
    """What became of settings: not answered yet, in force, refused by the guard, or overtaken."""

    PENDING = "pending"
    APPLIED = "applied"
    REFUSED = "refused"
    REPLACED = "replaced"


class RequestModel(BaseModel):
    """Base of what is taken: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid")


class RobotSummary(BaseModel):
    """A robot in the overview. `state` is None until its guard has told one."""

    name: str
    app: str | None
    ros: int | None
    connected: bool
    seen: int | None
    dry_run: bool
    revision: int
    outcome: SettingsOutcome | None
    stop: EmergencyStop | None
    dropped: int
    state: GuardState | None


class NodeParameters(BaseModel):
    """A coordination node as the paper's console shows it: its risk model, and what may be set.

    `violated_rule`, `violation_cause` and `violation_details` are the paper's words (section 6.3).
    `plan` is the node as the plan has it, `settings` what differs, `effective` what is in force;
    `rights` is what the one who asks may do, `policies` what may be selected.
    """

    id: str
    type: str
    description: str
    mode: str
    topics: list[str]
    trigger_time: int | None
    violated_rule: str
    violation_cause: str
    violation_details: str
    risk_information: dict[str, Any]
    plan: dict[str, Any]
    effective: dict[str, Any]
    settings: NodeSettings
    policies: list[str]
    mandatory: list[str]
    rights: list[Right]
    override: TimedOverride | None


class SettingsView(BaseModel):
    """Settings at one revision, who made them and what the guard said to them."""

    revision: int
    settings: Settings
    by: str
    reason: str
    at: int
    outcome: SettingsOutcome
    error: str
    answered: int | None


class SettingsChange(RequestModel):
    """A change of settings: `nodes` are merged into those of `revision`, the newest one.

    In each node what is given replaces what was set; null takes it back to what the plan says. The
    keys are those of NodeSettings. A duration is a whole number of ns, or a text with a unit as in
    the plan ("0.5 s"); a velocity, or a threshold, a number in SI units or such a text.
    """

    revision: int = Field(ge=0, le=(1 << 53) - 1)
    nodes: dict[str, dict[str, Any]]
    reason: Reason = ""


class OverrideRequest(RequestModel):
    """For `duration` seconds what the node forbids passes."""

    duration: float = Field(gt=0, le=3600)
    reason: Annotated[str, StringConstraints(strip_whitespace=True, min_length=3, max_length=200)]


class ReleaseRequest(RequestModel):
    """The end of the emergency stop that somebody has seen at `revision`; it needs a reason."""

    revision: int = Field(ge=0, le=(1 << 53) - 1)
    reason: Reason


class EventView(BaseModel):
    """A stored event; `id` counts up in the order of storing."""

    id: int
    robot: str
    at: int
    kind: EventKind
    level: GuardEventLevel
    node: str
    topic: str
    flow: str
    publisher: str
    policy: str
    decision: str
    reason: str
    revision: int
    values: dict[str, Any]


class EventPage(BaseModel):
    """Events, newest first; `next` continues with older ones (`before`), None at the end."""

    events: list[EventView]
    next: int | None
