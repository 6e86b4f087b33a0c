"""What the HTTP API says and takes; the console lives on nothing else. Times: wall clock, ns.

Durations that people give are seconds. Unknown keys of a request are refused.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

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
Password = Annotated[str, StringConstraints(min_length=12, max_length=200)]


class UserRole(StringEnum):
    """What a user is; one may be several."""

    ADMIN = "admin"
    DEVELOPER = "developer"
    END_USER = "end_user"


class AccessScope(StringEnum):
    """What an API token is for; the last three are what the roles may do."""

    GUARD = "guard"
    METRICS = "metrics"
    READ = "read"
    END_USER = "end_user"
    DEVELOPER = "developer"
    ADMIN = "admin"


class Right(StringEnum):
    """What may be done to a coordination node (paper, table of policies, Executor column)."""

    SELECT_POLICY = "select_policy"
    SET_PRIORITY = "set_priority"
    SET_BLOCK = "set_block"
    SET_TIMEOUT = "set_timeout"
    SET_DURATIONS = "set_durations"
    SET_THRESHOLD = "set_threshold"
    SET_MAX_VEL_LIMIT = "set_max_vel_limit"
    SELECT_RULES = "select_rules"
    SET_RULES = "set_rules"
    OVERRIDE = "override"


class SettingsOutcome(StringEnum):
    """What became of settings: not answered yet, in force, refused by the guard, or overtaken."""

    PENDING = "pending"
    APPLIED = "applied"
    REFUSED = "refused"
    REPLACED = "replaced"


class RequestModel(BaseModel):
    """Base of what is taken: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid")


class Login(RequestModel):
    """A name and a password."""

    name: Annotated[str, StringConstraints(strip_whitespace=True, max_length=100)]
    password: str = Field(max_length=200)


class CurrentUser(BaseModel):
    """Who is logged in; `csrf` goes into the header X-CSRF-Token of every change."""

    name: str
    roles: list[UserRole]
    csrf: str


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


class StopRequest(RequestModel):
    """An emergency stop."""

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


class AuditEntry(BaseModel):
    """One line of the audit log."""

    id: int
    at: int
    who: str
    address: str
    action: str
    target: str
    detail: dict[str, Any]
    outcome: str


class AuditPage(BaseModel):
    """The audit log, newest first; `next` as with events."""

    entries: list[AuditEntry]
    next: int | None


class UserView(BaseModel):
    """A user, without the password."""

    name: str
    roles: list[UserRole]
    disabled: bool
    created: int


class NewUser(RequestModel):
    """A user to create."""

    name: Name
    password: Password
    roles: list[UserRole] = Field(min_length=1, max_length=3)


class UserChange(RequestModel):
    """What changes for a user; None stays. A new password or role ends the user's sessions."""

    password: Password | None = None
    roles: list[UserRole] | None = Field(default=None, min_length=1, max_length=3)
    disabled: bool | None = None


class PasswordChange(RequestModel):
    """One's own password."""

    old: str = Field(max_length=200)
    new: Password


class NewToken(RequestModel):
    """A token to create; `robot` is required by, and only for, the scope `guard`."""

    name: Annotated[Name, StringConstraints(max_length=80)]
    scopes: list[AccessScope] = Field(min_length=1, max_length=6)
    robot: Name | None = None
    days: int | None = Field(default=None, ge=1, le=3650)


class TokenView(BaseModel):
    """A token, without its secret."""

    name: str
    scopes: list[AccessScope]
    robot: str | None
    by: str
    created: int
    expires: int | None
    revoked: int | None
    used: int | None


class CreatedToken(TokenView):
    """A new token; its secret is told this once."""

    secret: str


class NewWebhook(RequestModel):
    """Where events of at least `level` go by POST, signed with HMAC-SHA256 of `secret`."""

    url: str = Field(max_length=1000, pattern=r"^https?://")
    level: GuardEventLevel = GuardEventLevel.WARNING


class WebhookView(BaseModel):
    """A webhook; `failing` says why the last call failed, or nothing."""

    id: int
    url: str
    level: GuardEventLevel
    created: int
    failing: str


class CreatedWebhook(WebhookView):
    """A new webhook; the secret that signs its calls is told this once."""

    secret: str


class Health(BaseModel):
    """The service is well."""

    status: Literal["ok"] = "ok"


class ErrorResponse(BaseModel):
    """An error: what is wrong, and what to do about it."""

    error: str
    help: str = ""


class RevisionConflict(ErrorResponse):
    """A change that was for older settings than the newest ones."""

    newest: SettingsView
