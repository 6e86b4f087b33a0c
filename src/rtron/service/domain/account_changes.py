"""Changes of what users and tokens may do, and where, as they are applied now or wait.

What gives rights waits for a second admin, if four eyes are switched on.

Secrets are in them as hashes only: a change that waits is in the database.
"""

from collections.abc import Collection
from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from rtron.service.domain.audit_events import truncated_json
from rtron.service.domain.principal import AccessScope, UserRole

_ROLE_SCOPES = frozenset({AccessScope.END_USER, AccessScope.DEVELOPER, AccessScope.ADMIN})


class _Change(BaseModel):
    model_config = ConfigDict(frozen=True)


class AddUser(_Change):
    """A new user."""

    name: str
    password_hash: str = Field(repr=False)
    roles: frozenset[UserRole]
    groups: frozenset[str] | None = None
    action: Literal["add user"] = "add user"


class ChangeUser(_Change):
    """Another password, roles or groups, or whether the user may log in; None stays.

    `has_all_robots`: the user has no groups any more.
    """

    name: str
    password_hash: str | None = Field(default=None, repr=False)
    roles: frozenset[UserRole] | None = None
    disabled: bool | None = None
    groups: frozenset[str] | None = None
    has_all_robots: bool = False
    action: Literal["change user"] = "change user"


class ResetSecondFactor(_Change):
    """A user's login takes no code any more."""

    name: str
    action: Literal["reset second factor"] = "reset second factor"


class CreateToken(_Change):
    """A new token, whose secret has this digest."""

    name: str
    digest: str = Field(repr=False)
    scopes: frozenset[AccessScope]
    robot: str | None
    days: int
    groups: frozenset[str] | None = None
    action: Literal["create token"] = "create token"


class LabelRobot(_Change):
    """The labels of a robot, instead of those that it has: they say who may change it."""

    name: str
    labels: frozenset[str]
    action: Literal["labels"] = "labels"


class FormGroup(_Change):
    """The robots of a group, instead of those that it has."""

    name: str
    robots: frozenset[str]
    action: Literal["group"] = "group"


AccountChange: TypeAlias = (
    AddUser | ChangeUser | ResetSecondFactor | CreateToken | LabelRobot | FormGroup
)
CHANGES: TypeAdapter[AccountChange] = TypeAdapter(
    Annotated[AccountChange, Field(discriminator="action")]
)


def gives_rights(
    change: AccountChange,
    roles: Collection[UserRole] = (),
    groups: Collection[str] | None = None,
    *,
    is_disabled: bool = False,
    members: Collection[str] = (),
) -> bool:
    """Tell whether somebody may do more after a change; before, the user has these.

    Whoever sets a password, or takes the second factor away, may do what that user may. `members`
    are the labels that the robot has, or the robots of the group: who has more may be changed by
    more.
    """
    if isinstance(change, LabelRobot):
        return not change.labels <= set(members)
    if isinstance(change, FormGroup):
        return not change.robots <= set(members)
    if isinstance(change, CreateToken):
        return not _ROLE_SCOPES.isdisjoint(change.scopes)
    if isinstance(change, ChangeUser):
        has_more_roles = change.roles is not None and not change.roles <= set(roles)
        is_enabled = is_disabled and change.disabled is False
        has_more_robots = groups is not None and (
            change.has_all_robots or not (change.groups or frozenset()) <= set(groups)
        )
        return change.password_hash is not None or has_more_roles or has_more_robots or is_enabled
    return True


def change_detail(change: AccountChange) -> dict[str, object]:
    """Return what people may know of a change."""
    secrets = {"password_hash", "digest", "action", "name", "has_all_robots"}
    detail = change.model_dump(mode="json", exclude=secrets, exclude_none=True)
    detail = {key: sorted(each) if isinstance(each, list) else each for key, each in detail.items()}
    if isinstance(change, FormGroup):
        detail["robots"] = truncated_json(detail["robots"])
    if isinstance(change, ChangeUser):
        detail["password"] = change.password_hash is not None
        detail |= {"groups": None} if change.has_all_robots else {}
    return detail
