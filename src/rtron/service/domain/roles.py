"""The names of roles, of scopes of API tokens, and of rights; `rights.py` says who has which."""

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
