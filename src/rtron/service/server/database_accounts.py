"""Create users and tokens in the database itself: the first ones, or for a lost password."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from rtron.errors import InputError, plain_reason
from rtron.service.api.schemas import NewToken, NewUser
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import wall_clock
from rtron.service.store.accounts.logins import end_sessions
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.random_secrets import new_password
from rtron.service.store.accounts.second_factors import (
    begin_enrolment,
    confirm_enrolment,
    remove_second_factor,
)
from rtron.service.store.accounts.tokens import TokenSpec, create_token, revoke_token
from rtron.service.store.accounts.users import (
    add_user,
    get_user,
    set_disabled,
    set_groups,
    set_password,
)
from rtron.service.store.audit import record_event
from rtron.service.store.database import Database

_Model = TypeVar("_Model", bound=BaseModel)


def create_token_record(database: Database, actor: str, request: Mapping[str, object]) -> str:
    """Make a token as NewToken says; return its secret. ConflictError if it is there already."""
    new = _validated(NewToken, request)
    spec = TokenSpec(
        name=new.name, scopes=new.scopes, robot=new.robot, days=new.days, groups=new.groups
    )
    event = AuditEvent(who=actor, action="create token", target=new.name, detail=request)
    with database.session() as session:
        _, secret = create_token(session, wall_clock(), actor, spec)
        record_event(session, wall_clock(), event)
    return secret


def revoke_token_record(database: Database, actor: str, name: str) -> None:
    """Revoke a token; NotFoundError if there is none."""
    with database.session() as session:
        revoke_token(session, wall_clock(), name)
        record_event(
            session, wall_clock(), AuditEvent(who=actor, action="revoke token", target=name)
        )


def create_user_record(
    database: Database,
    actor: str,
    name: str,
    roles: Sequence[str],
    groups: Sequence[str] | None = None,
) -> str:
    """Add a user; return the password. InputError, or ConflictError if the name is taken."""
    secret = new_password()
    request = {"roles": list(roles), "groups": groups}
    new = _validated(NewUser, {"name": name, "password": secret, **request})
    event = AuditEvent(who=actor, action="add user", target=name, detail=request)
    with database.session() as session:
        user = add_user(session, wall_clock(), new.name, hash_password(secret), new.roles)
        set_groups(user, new.groups)
        record_event(session, wall_clock(), event)
    return secret


def reset_password(database: Database, actor: str, name: str) -> str:
    """Give a user a new password and let the user log in; return it. NotFoundError if none."""
    secret = new_password()
    with database.session() as session:
        user = get_user(session, name)
        set_password(session, user, hash_password(secret))
        set_disabled(session, user, disabled=False)
        record_event(
            session, wall_clock(), AuditEvent(who=actor, action="reset password", target=name)
        )
    return secret


def begin_second_factor(database: Database, name: str) -> str:
    """Give a user a key for one-time codes, not in force yet; return it. ConflictError if any."""
    with database.session() as session:
        return begin_enrolment(session, wall_clock(), get_user(session, name))


def confirm_second_factor(database: Database, actor: str, name: str, code: str) -> Sequence[str]:
    """Put the key in force with a code of it; return the recovery codes, or ForbiddenError."""
    event = AuditEvent(who=actor, action="enrol second factor", target=name)
    with database.session() as session:
        user = get_user(session, name)
        codes = confirm_enrolment(session, wall_clock(), user, code)
        end_sessions(session, user.id)
        record_event(session, wall_clock(), event)
    return codes


def reset_second_factor(database: Database, actor: str, name: str) -> None:
    """Let a user log in with the password alone; NotFoundError if there is no such user."""
    event = AuditEvent(who=actor, action="reset second factor", target=name)
    with database.session() as session:
        user = get_user(session, name)
        remove_second_factor(session, user)
        end_sessions(session, user.id)
        record_event(session, wall_clock(), event)


def _validated(model: type[_Model], values: Mapping[str, object]) -> _Model:
    try:
        return model.model_validate(values)
    except ValidationError as error:
        problem = error.errors(include_input=False)[0]
        location = ".".join(map(str, problem["loc"]))
        help = "names are letters, digits and . _ @ -"
        raise InputError(f"{location}: {plain_reason(problem['msg'])}", help=help) from None
