"""What only HTTP requests and responses have; times are wall clock, ns."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, StringConstraints

from rtron.service.domain.roles import AccessScope, UserRole
from rtron.service.domain.schemas import Name, Reason, RequestModel, SettingsView
from rtron.vocabulary import GuardEventLevel

Password = Annotated[str, StringConstraints(min_length=12, max_length=200)]


class Login(RequestModel):
    """A name and a password."""

    name: Annotated[str, StringConstraints(strip_whitespace=True, max_length=100)]
    password: str = Field(max_length=200)


class CurrentUser(BaseModel):
    """Who is logged in; `csrf` goes into the header X-CSRF-Token of every change."""

    name: str
    roles: list[UserRole]
    csrf: str


class StopRequest(RequestModel):
    """An emergency stop."""

    reason: Reason = ""


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
