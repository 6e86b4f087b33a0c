"""Users and tokens, changed in the database itself: to begin with, and for a lost password."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from rtron.errors import InputError
from rtron.service.domain.clock import wall
from rtron.service.domain.schemas import NewToken, NewUser
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.secrets import new_password
from rtron.service.store.accounts.tokens import TokenWish, create_token, revoke_token
from rtron.service.store.accounts.users import add_user, set_disabled, set_password, the_user
from rtron.service.store.audit import Deed, record
from rtron.service.store.database import Database

_Model = TypeVar("_Model", bound=BaseModel)


def make_token(database: Database, who: str, wanted: Mapping[str, object]) -> str:
    """Make a token as NewToken says; return its secret. ConflictError if it is there already."""
    new = _checked(NewToken, wanted)
    wish = TokenWish(name=new.name, scopes=new.scopes, robot=new.robot, days=new.days)
    deed = Deed(who=who, action="create token", target=new.name, detail=wanted)
    with database.session() as session:
        _, secret = create_token(session, wall(), who, wish)
        record(session, wall(), deed)
    return secret


def end_token(database: Database, who: str, name: str) -> None:
    """Revoke a token; NotFoundError if there is none."""
    with database.session() as session:
        revoke_token(session, wall(), name)
        record(session, wall(), Deed(who=who, action="revoke token", target=name))


def make_user(database: Database, who: str, name: str, roles: Sequence[str]) -> str:
    """Add a user; return the password. InputError, or ConflictError if the name is taken."""
    secret = new_password()
    new = _checked(NewUser, {"name": name, "password": secret, "roles": roles})
    deed = Deed(who=who, action="add user", target=name, detail={"roles": list(roles)})
    with database.session() as session:
        add_user(session, wall(), new.name, hash_password(secret), new.roles)
        record(session, wall(), deed)
    return secret


def reset_password(database: Database, who: str, name: str) -> str:
    """Give a user a new password and let the user log in; return it. NotFoundError if none."""
    secret = new_password()
    with database.session() as session:
        user = the_user(session, name)
        set_password(session, user, hash_password(secret))
        set_disabled(session, user, disabled=False)
        record(session, wall(), Deed(who=who, action="reset password", target=name))
    return secret


def _checked(model: type[_Model], values: Mapping[str, object]) -> _Model:
    try:
        return model.model_validate(values)
    except ValidationError as error:
        fault = error.errors(include_input=False)[0]
        place = ".".join(map(str, fault["loc"]))
        help = "names are letters, digits and . _ @ -"
        raise InputError(f"{place}: {fault['msg']}", help=help) from None
