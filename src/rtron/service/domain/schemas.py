"""Settings, robots, events and incidents as the HTTP API has them; the console uses nothing else.

Times are wall clock, ns; durations that people give are seconds. Unknown keys of a request are
refused.
"""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from rtron.service.domain.alarms import Acknowledgement
from rtron.service.domain.principal import Right
from rtron.vocabulary import (
    Alarm,
    EmergencyStop,
    EventKind,
    GuardEventLevel,
    GuardState,
    NodeSettings,
    Settings,
    StringEnum,
    TimedOverride,
    visible_text,
)

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.@-]{0,99}$")]
MIN_REASON_LENGTH = 3


def _require_text(text: str) -> str:
    if len(text) < MIN_REASON_LENGTH:
        raise ValueError(f"say why, in at least {MIN_REASON_LENGTH} characters")
    return text


_Visible = AfterValidator(visible_text)
Reason = Annotated[str, StringConstraints(strip_whitespace=True, max_length=200), _Visible]
"""Why; what nobody can see is no reason."""
RequiredReason = Annotated[Reason, AfterValidator(_require_text)]


class WebhookLevel(StringEnum):
    """What goes to a webhook: events of at least a level, or the signed heads of the audit log."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"
    HEADS = "heads"


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
    """A robot in the overview. `state` is None until its guard has told one, or is left out.

    `alarms`, `overridden` and `stopped` are the state's; `acknowledged` is what people have seen;
    so many `requests` wait for a person.
    """

    name: str
    labels: list[str]
    app: str | None
    ros: int | None
    connected: bool
    seen: int | None
    dry_run: bool
    revision: int
    outcome: SettingsOutcome | None
    stop: EmergencyStop | None
    dropped: int
    alarms: tuple[Alarm, ...]
    acknowledged: tuple[Acknowledgement, ...]
    overridden: tuple[str, ...]
    stopped: bool
    requests: int = 0
    state: GuardState | None = None


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
    the plan ("0.5 s"); a velocity, or a threshold, a number in SI units or such a text. Without a
    reason it is refused.
    """

    revision: int = Field(ge=0, le=(1 << 53) - 1)
    nodes: dict[str, dict[str, Any]]
    reason: Reason = ""


class RestoreRequest(RequestModel):
    """The nodes' settings of revision `restored` again; `revision` is the newest one."""

    revision: int = Field(ge=0, le=(1 << 53) - 1)
    restored: int = Field(ge=0, le=(1 << 53) - 1)
    reason: RequiredReason


class OverrideRequest(RequestModel):
    """For `duration` seconds what the node forbids passes."""

    duration: float = Field(gt=0, le=3600)
    reason: RequiredReason


class OverrideEnd(RequestModel):
    """The end of an override before its time; without a reason it is refused."""

    reason: Reason = ""


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


class IncidentSummary(BaseModel):
    """An incident in short: its gravest cause, who was in command then, the settings' revision.

    `at` is the robot's wall clock, `stored` the service's (ns); `size` is that of the file on the
    robot, bytes. `id` counts up in the order of storing.
    """

    id: int
    robot: str
    name: str
    stored: int
    at: int
    app: str
    size: int
    revision: int
    kind: Literal["intervention", "stop", "alarm"]
    topic: str
    flow: str
    reason: str
    owner: str
    publisher: str
    causes: int


class IncidentPage(BaseModel):
    """Incidents, newest first; `next` continues with older ones (`before`), None at the end."""

    incidents: list[IncidentSummary]
    next: int | None


class StoredIncident(BaseModel):
    """An incident with all that its robot has told of it, `rtron.incident_report/1`."""

    robot: str
    stored: int
    report: dict[str, Any]
