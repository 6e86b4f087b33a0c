"""Sign-in at an OpenID provider: what its configuration may say, and which roles a claim gives."""

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from rtron.service.domain.client_address import is_loopback_name
from rtron.service.domain.principal import UserRole
from rtron.service.domain.schemas import Name

CALLBACK_PATH = "/api/v1/login/oidc/callback"
_MAX_NAME = 100
_SECRET_LENGTH = 43
"""256 bits in the letters of base 64."""


def _check_url(url: str) -> str:
    parts = urlsplit(url)
    is_safe = parts.scheme == "https" or (
        parts.scheme == "http" and is_loopback_name(parts.hostname or "")
    )
    if not (is_safe and parts.hostname) or parts.query or parts.fragment or parts.username:
        raise ValueError("give an https address without query; http is for this machine only")
    return url


_Url = Annotated[str, Field(max_length=500), AfterValidator(_check_url)]
_Text = Annotated[str, Field(min_length=1, max_length=200)]


class OidcConfig(BaseModel):
    """How users sign in at a provider; `roles` are those of each value of the roles' claim.

    So are `groups`, of robots; without any, an admin says here who is limited to which.
    `public_url` is where browsers reach the console. A claim within another one is named with a
    dot. A public client has no secret.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    issuer: _Url
    client_id: _Text
    public_url: _Url
    roles: dict[_Text, frozenset[UserRole]] = Field(min_length=1)
    groups: dict[_Text, frozenset[Name]] = Field(default_factory=dict)
    client_secret_file: _Text | None = None
    ca_file: _Text | None = None
    display_name: _Text = "single sign-on"
    roles_claim: _Text = "groups"
    name_claim: _Text = "preferred_username"
    scope: _Text = "openid profile"
    provider_checks_second_factor: bool = False

    @property
    def redirect_uri(self) -> str:
        """Where the provider sends the browser back to."""
        return self.public_url.rstrip("/") + CALLBACK_PATH

    def roles_of(self, claims: Mapping[str, Any]) -> frozenset[UserRole]:
        """Return the roles that claims give: none for what no line maps."""
        granted = (self.roles.get(each, frozenset()) for each in self._values(claims))
        return frozenset[UserRole]().union(*granted)

    def groups_of(self, claims: Mapping[str, Any]) -> frozenset[str] | None:
        """Return the groups of robots that claims give; None if no line maps any."""
        if not self.groups:
            return None
        granted = (self.groups.get(each, frozenset()) for each in self._values(claims))
        return frozenset[str]().union(*granted)

    def _values(self, claims: Mapping[str, Any]) -> list[str]:
        values = _claim(claims, self.roles_claim)
        named = values if isinstance(values, list) else [values]
        return [each for each in named if isinstance(each, str)]

    def name_of(self, claims: Mapping[str, Any]) -> str:
        """Return the user's name; its subject where there is no name."""
        name = _claim(claims, self.name_claim)
        return name if isinstance(name, str) and name else str(claims["sub"])


@dataclass(frozen=True, slots=True, kw_only=True)
class ProviderUser:
    """Who has signed in at a provider; it gives a `subject` to nobody else.

    Of robots, the user may change those of `groups`; None: the provider does not say.
    """

    subject: str
    name: str
    roles: frozenset[UserRole]
    groups: frozenset[str] | None = None


class SignInProblem(str, Enum):
    """Why a sign-in gives nothing, in words that the console knows."""

    NO_ROLE = "no_role"
    NAME_TAKEN = "name_taken"
    BAD_NAME = "bad_name"
    DISABLED = "disabled"
    REFUSED = "refused"
    EXPIRED = "expired"
    FAILED = "failed"
    BUSY = "busy"


class SignInError(Exception):
    """A sign-in that gives nothing."""

    def __init__(self, problem: SignInProblem, detail: str = "") -> None:
        super().__init__(f"{problem.value}: {detail}" if detail else problem.value)
        self.problem = problem


@dataclass(frozen=True, slots=True, kw_only=True)
class PendingSignIn:
    """What binds the provider's answer to the browser that asked; it is in its cookie."""

    state: str
    nonce: str
    verifier: str

    @classmethod
    def begin(cls) -> "PendingSignIn":
        """Return a new one, of 256 random bits each."""
        return cls(**{name: secrets.token_urlsafe(32) for name in ("state", "nonce", "verifier")})

    @classmethod
    def parse(cls, cookie: str) -> "PendingSignIn":
        """Return what a cookie says; SignInError if that is nothing that we have begun.

        Who writes the cookie could leave the nonce out, which then would not be compared.
        """
        parts = cookie.split(".")
        if list(map(len, parts)) != [_SECRET_LENGTH] * 3:
            raise SignInError(SignInProblem.EXPIRED, "no sign-in has begun in this browser")
        return cls(state=parts[0], nonce=parts[1], verifier=parts[2])

    def __str__(self) -> str:
        """Return what `parse` reads."""
        return f"{self.state}.{self.nonce}.{self.verifier}"


def _claim(claims: Mapping[str, Any], path: str) -> object:
    """Return a claim by its name, or by names within each other; None if it is not there."""
    if path in claims:
        return claims[path]
    found: object = claims
    for part in path.split("."):
        found = found.get(part) if isinstance(found, Mapping) else None
    return found
