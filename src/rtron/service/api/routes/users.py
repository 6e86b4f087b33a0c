"""Users: added, changed and removed by an admin."""

from fastapi import APIRouter

from rtron.service.api.audit_transaction import audit_transaction
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import ServiceDependency
from rtron.service.api.schemas import NewUser, UserChange, UserView
from rtron.service.domain.roles import UserRole
from rtron.service.domain.schemas import Name
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.users import (
    add_user,
    all_users,
    get_user,
    remove_user,
    set_disabled,
    set_password,
    set_roles,
)
from rtron.service.store.tables import UserRow

router = APIRouter(prefix="/users")


@router.get("")
def list_users(_caller: AdminOnly, service: ServiceDependency) -> list[UserView]:
    """Return every user, by name."""
    with service.database.session() as session:
        return [_view(user) for user in all_users(session)]


@router.post("", status_code=201)
def create_user(new: NewUser, caller: AdminOnly, service: ServiceDependency) -> UserView:
    """Add a user."""
    hashed = hash_password(new.password)
    roles = sorted(set(map(str, new.roles)))
    with audit_transaction(
        service, caller.audit_event("add user", new.name, roles=roles)
    ) as session:
        return _view(add_user(session, service.clock(), new.name, hashed, new.roles))


@router.patch("/{user}")
def change_user(
    user: Name, change: UserChange, caller: AdminOnly, service: ServiceDependency
) -> UserView:
    """Change a user's password, roles, or whether the user may log in; the sessions end."""
    hashed = hash_password(change.password) if change.password else None
    detail = change.model_dump(mode="json", include={"roles", "disabled"}, exclude_none=True)
    event = caller.audit_event("change user", user, **detail, password=hashed is not None)
    with audit_transaction(service, event) as session:
        row = get_user(session, user)
        if hashed:
            set_password(session, row, hashed)
        if change.roles is not None:
            set_roles(session, row, change.roles)
        if change.disabled is not None:
            set_disabled(session, row, disabled=change.disabled)
        return _view(row)


@router.delete("/{user}", status_code=204)
def delete_user(user: Name, caller: AdminOnly, service: ServiceDependency) -> None:
    """Remove a user; what the user did stays in the audit log."""
    with audit_transaction(service, caller.audit_event("remove user", user)) as session:
        remove_user(session, get_user(session, user))


def _view(user: UserRow) -> UserView:
    roles = [UserRole(role) for role in user.roles]
    return UserView(name=user.name, roles=roles, disabled=user.disabled, created=user.created)
