"""Who makes a request: a user with a session, or a program with a token.

Robots that share a label are a group. Who has groups may change the robots of these only, who has
none every robot. Seeing is not limited.
"""

from collections.abc import Collection
from dataclasses import dataclass

from rtron.errors import InputError
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import ForbiddenError
from rtron.vocabulary import StringEnum


class UserRole(StringEnum):
    """What a user is; one may be several."""

    ADMIN = "admin"
    DEVELOPER = "developer"
    END_USER = "end_user"


class SessionStage(StringEnum):
    """What a browser's session may do: everything, or only show a code, or only enrol one."""

    COMPLETE = "complete"
    CODE = "code"
    ENROLMENT = "enrolment"


class EnrolmentProof(StringEnum):
    """What somebody who has a session shows before a second factor is enrolled."""

    PASSWORD = "password"  # noqa: S105 - what is to be shown
    SIGN_IN = "sign-in"
    NONE = "none"


class AccessScope(StringEnum):
    """What an API token is for; the last three are what the roles may do."""

    GUARD = "guard"
    METRICS = "metrics"
    READ = "read"
    END_USER = "end_user"
    DEVELOPER = "developer"
    ADMIN = "admin"


TOKEN_ROLES = {
    AccessScope.END_USER: UserRole.END_USER,
    AccessScope.DEVELOPER: UserRole.DEVELOPER,
    AccessScope.ADMIN: UserRole.ADMIN,
}
"""The roles that a token has by its scopes."""


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Principal:
    """Who asks. A token is called `token:NAME`; its scopes are those of roles, too.

    `session` is the digest of a browser's session, `csrf` its token; both "" for a token. Before
    its `stage` is complete, a session has no role.
    Of the robots, it may change those of `groups`; None: all.
    """

    name: str
    roles: frozenset[UserRole]
    scopes: frozenset[AccessScope] = frozenset()
    address: str = ""
    session: str = ""
    csrf: str = ""
    stage: SessionStage = SessionStage.COMPLETE
    groups: frozenset[str] | None = None

    @property
    def may_read(self) -> bool:
        """Whether robots, events and settings may be seen."""
        return bool(self.roles) or AccessScope.READ in self.scopes

    def has_stage(self, stage: SessionStage) -> bool:
        """Whether it is a session, and of that stage."""
        return bool(self.session) and self.stage is stage

    def audit_event(self, action: str, target: str, **detail: object) -> AuditEvent:
        """Return what the audit log says of what the caller does."""
        return AuditEvent(
            who=self.name, action=action, target=target, address=self.address, detail=detail
        )


def is_within_reach(groups: Collection[str] | None, labels: Collection[str]) -> bool:
    """Tell whether somebody with these groups (None: all) may change a robot with these labels."""
    return groups is None or not set(groups).isdisjoint(labels)


def check_reach(caller: Principal, robot: str, labels: Collection[str]) -> None:
    """Raise ForbiddenError unless a robot with these labels is in a group of the caller."""
    if error := reach_error(caller, robot, labels):
        raise error


def reach_error(caller: Principal, robot: str, labels: Collection[str]) -> ForbiddenError | None:
    """Return why a caller may not change a robot with these labels, None where it may."""
    if is_within_reach(caller.groups, labels):
        return None
    groups = ", ".join(sorted(caller.groups or ()))
    help = f"{caller.name} may change the robots of {groups or 'no group'}"
    return ForbiddenError(f"{robot} is in no group of {caller.name}", help=help)


def check_group_limit(
    groups: Collection[str] | None, roles: Collection[UserRole | AccessScope]
) -> None:
    """Raise InputError for groups of who manages the users, or of who changes nothing."""
    if groups is None:
        return
    names = set(map(str, roles))
    if UserRole.ADMIN in names:
        help = "leave the groups out, or the role admin"
        raise InputError("an admin manages all groups, and has none", help=help)
    if names.isdisjoint(set(map(str, UserRole))):
        raise InputError("groups limit what may be changed, which takes a role")


def group_set(groups: Collection[str] | None, roles: Collection[UserRole]) -> frozenset[str] | None:
    """Return the groups that limit who has these roles; None: every robot, as for each admin."""
    return None if groups is None or UserRole.ADMIN in roles else frozenset(groups)
