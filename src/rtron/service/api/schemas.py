"""What only HTTP requests and responses have; times are wall clock, ns."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, Field, StringConstraints

from rtron.service.domain.principal import AccessScope, EnrolmentProof, SessionStage, UserRole
from rtron.service.domain.schemas import Name, Reason, RequestModel, SettingsView, WebhookLevel
from rtron.service.store.accounts.tokens import DEFAULT_DAYS
from rtron.service.store.fleet.labels import MAX_LABELS

MAX_GROUPS = 100
"""The most groups of one user or token."""

MAX_STOPS = 1000
"""The most robots that one request stops."""

NO_REASON = "no reason given"

Groups = Annotated[list[Name], Field(min_length=1, max_length=MAX_GROUPS)]
Password = Annotated[str, StringConstraints(min_length=12, max_length=200)]


class Login(RequestModel):
    """A name and a password."""

    name: Annotated[str, StringConstraints(strip_whitespace=True, max_length=100)]
    password: str = Field(max_length=200)


class CurrentUser(BaseModel):
    """Who is logged in; `csrf` goes into the header X-CSRF-Token of every change.

    Before the `stage` is complete, there are no roles: a code has to be shown, or enrolled.
    """

    name: str
    roles: list[UserRole]
    csrf: str
    stage: SessionStage = SessionStage.COMPLETE
    groups: list[str] | None = None


class LoginMethods(BaseModel):
    """How one may log in beside name and password: `oidc` is what the provider is called."""

    oidc: str | None


class OneTimeCode(RequestModel):
    """A code of the phone, or a recovery code."""

    code: str = Field(min_length=6, max_length=40)


class SecondFactorView(BaseModel):
    """Whether one has a second factor, and how many recovery codes are left.

    `proof` is what enrolling one takes: the password, or a new sign-in at the provider.
    """

    is_enrolled: bool
    recovery_codes: int
    proof: EnrolmentProof


class OwnPassword(RequestModel):
    """One's own password; who signs in at a provider has none."""

    password: str = Field(default="", max_length=200)


class Enrolment(BaseModel):
    """The key of one-time codes, base 32; `uri` is what `qr`, rows of 0 and 1, shows to a phone."""

    key: str
    uri: str
    qr: list[str]


class EnrolledFactor(BaseModel):
    """The recovery codes, told this once, and the session from now on."""

    recovery_codes: list[str]
    user: CurrentUser


class RobotQuery(RequestModel):
    """Which robots a page has: `text` is a part of the name, `after` the last name before.

    Without `states` it has no `state`, which is most of it.
    """

    after: str = Field(default="", max_length=200)
    limit: int = Field(default=1000, ge=1, le=1000)
    text: str = Field(default="", max_length=200)
    app: str | None = Field(default=None, max_length=200)
    label: str | None = Field(default=None, max_length=100)
    connected: bool | None = None
    states: bool = True


class RobotLabels(RequestModel):
    """The labels of a robot; each names a group."""

    labels: list[Name] = Field(max_length=MAX_LABELS)


class GroupMembers(RequestModel):
    """The robots of a group."""

    robots: list[Name] = Field(max_length=10_000)


class GroupView(BaseModel):
    """A group, and how many robots it has."""

    name: str
    robots: int


class StopRequest(RequestModel):
    """An emergency stop, never refused for want of a reason: one without says so."""

    reason: Annotated[Reason, AfterValidator(lambda text: text or NO_REASON)] = NO_REASON


class StopView(SettingsView):
    """The settings with a stop; not `connected`: it waits for the robot's guard."""

    connected: bool


class StopsRequest(StopRequest):
    """An emergency stop of several robots, stored together: who stops another one waits for it."""

    robots: list[Name] = Field(min_length=1, max_length=MAX_STOPS)


class StopsResult(BaseModel):
    """To which robots a stop is sent, which it waits for, and for which it failed, and why."""

    sent: list[str]
    waiting: list[str]
    failed: dict[str, str]


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
    """A user, without the password; who signs in at a provider gets the roles there."""

    name: str
    roles: list[UserRole]
    disabled: bool
    is_from_provider: bool
    created: int
    groups: list[str] | None


class PendingChangeView(BaseModel):
    """A change that waits for another admin than `by`, and than `owner`, the person behind it."""

    id: int
    action: str
    target: str
    detail: dict[str, Any]
    by: str
    owner: str
    created: int
    expires: int


class NewUser(RequestModel):
    """A user to create."""

    name: Name
    password: Password
    roles: list[UserRole] = Field(min_length=1, max_length=3)
    groups: Groups | None = None


class UserChange(RequestModel):
    """What changes for a user; None stays. A new password or role ends the user's sessions.

    `groups` that are given as null mean every robot.
    """

    password: Password | None = None
    roles: list[UserRole] | None = Field(default=None, min_length=1, max_length=3)
    disabled: bool | None = None
    groups: Groups | None = None


class PasswordChange(RequestModel):
    """One's own password."""

    old: str = Field(max_length=200)
    new: Password


class NewToken(RequestModel):
    """A token to create for so many days; `robot` is required by, and only for, a `guard`."""

    name: Annotated[Name, StringConstraints(max_length=80)]
    scopes: list[AccessScope] = Field(min_length=1, max_length=6)
    robot: Name | None = None
    groups: Groups | None = None
    days: int = Field(default=DEFAULT_DAYS, ge=1, le=3650)


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
    groups: list[str] | None


class CreatedToken(TokenView):
    """A token and its new secret, which is told this once."""

    secret: str


class PendingToken(BaseModel):
    """A token that a second admin has to approve before its secret, told this once, is one."""

    waits: PendingChangeView
    secret: str


class NewWebhook(RequestModel):
    """Where events of at least `level` go by POST, signed with HMAC-SHA256 of `secret`.

    With the level `heads` the signed heads of the audit log go there instead.
    """

    url: str = Field(max_length=1000, pattern=r"^https?://")
    level: WebhookLevel = WebhookLevel.WARNING


class WebhookView(BaseModel):
    """A webhook; `failing` says why the last call failed, or nothing."""

    id: int
    url: str
    level: WebhookLevel
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
