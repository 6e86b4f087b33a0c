"""Create users and tokens in the database itself: the first ones, or for a lost password."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from rtron.errors import InputError, plain_reason
from rtron.service.api.schemas import NewToken, NewUser
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import wall_clock
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.secrets import new_password
from rtron.service.store.accounts.tokens import TokenSpec, create_token, revoke_token
from rtron.service.store.accounts.users import add_user, get_user, set_disabled, set_password
from rtron.service.store.audit import record_event
from rtron.service.store.database import Database

_Model = TypeVar("_Model", bound=BaseModel)


def create_token_record(database: Database, actor: str, request: Mapping[str, object]) -> str:
    """Make a token as NewToken says; return its secret. ConflictError if it is there already."""
    new = _validated(NewToken, request)
    spec = TokenSpec(name=new.name, scopes=new.scopes, robot=new.robot, days=new.days)
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


def create_user_record(database: Database, actor: str, name: str, roles: Sequence[str]) -> str:
    """Add a user; return the password. InputError, or ConflictError if the name is taken."""
    secret = new_password()
    new = _validated(NewUser, {"name": name, "password": secret, "roles": roles})
    event = AuditEvent(who=actor, action="add user", target=name, detail={"roles": list(roles)})
    with database.session() as session:
        add_user(session, wall_clock(), new.name, hash_password(secret), new.roles)
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


def _validated(model: type[_Model], values: Mapping[str, object]) -> _Model:
    try:
        return model.model_validate(values)
    except ValidationError as error:
        problem = error.errors(include_input=False)[0]
        location = ".".join(map(str, problem["loc"]))
        help = "names are letters, digits and . _ @ -"
        raise InputError(f"{location}: {plain_reason(problem['msg'])}", help=help) from None
