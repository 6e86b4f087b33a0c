"""Users: added, changed and removed by an admin."""

from http import HTTPStatus

from fastapi import APIRouter, Response

from rtron.service.api.account_change_requests import change_account
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import ServiceDependency, audit_transaction
from rtron.service.api.schemas import NewUser, PendingChangeView, UserChange, UserView
from rtron.service.domain.account_changes import AddUser, ChangeUser, ResetSecondFactor
from rtron.service.domain.principal import UserRole, check_group_limit
from rtron.service.domain.schemas import Name
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.users import all_users, get_user, remove_user
from rtron.service.store.tables import TokenRow, UserRow

router = APIRouter(prefix="/users")


@router.get("")
def list_users(_caller: AdminOnly, service: ServiceDependency) -> list[UserView]:
    """Return every user, by name."""
    with service.database.session() as session:
        return [_view(user) for user in all_users(session)]


@router.post("", status_code=201)
def create_user(
    new: NewUser, caller: AdminOnly, service: ServiceDependency, response: Response
) -> UserView | PendingChangeView:
    """Add a user; 202 if a second admin has to approve that."""
    check_group_limit(new.groups, new.roles)
    change = AddUser(
        name=new.name,
        password_hash=hash_password(new.password),
        roles=frozenset(new.roles),
        groups=None if new.groups is None else frozenset(new.groups),
    )
    return _answer(change_account(service, caller, change), response)


@router.patch("/{user}")
def change_user(
    user: Name,
    change: UserChange,
    caller: AdminOnly,
    service: ServiceDependency,
    response: Response,
) -> UserView | PendingChangeView:
    """Change a user's password, roles, or whether the user may log in; the sessions end.

    202 if a second admin has to approve it.
    """
    requested = ChangeUser(
        name=user,
        password_hash=hash_password(change.password) if change.password else None,
        roles=None if change.roles is None else frozenset(change.roles),
        disabled=change.disabled,
        groups=None if change.groups is None else frozenset(change.groups),
        has_all_robots="groups" in change.model_fields_set and change.groups is None,
    )
    return _answer(change_account(service, caller, requested), response)


@router.delete("/{user}", status_code=204)
def delete_user(user: Name, caller: AdminOnly, service: ServiceDependency) -> None:
    """Remove a user; what the user did stays in the audit log."""
    with audit_transaction(service, caller.audit_event("remove user", user)) as session:
        remove_user(session, get_user(session, user))


@router.delete("/{user}/second-factor")
def reset_second_factor(
    user: Name, caller: AdminOnly, service: ServiceDependency, response: Response
) -> UserView | PendingChangeView:
    """Remove a user's second factor, for somebody who has lost it; the user's sessions end.

    202 if a second admin has to approve it.
    """
    return _answer(change_account(service, caller, ResetSecondFactor(name=user)), response)


def _answer(
    done: UserRow | TokenRow | PendingChangeView | None, response: Response
) -> UserView | PendingChangeView:
    if isinstance(done, PendingChangeView):
        response.status_code = HTTPStatus.ACCEPTED
        return done
    assert isinstance(done, UserRow)  # noqa: S101 - of a change of users
    return _view(done)


def _view(user: UserRow) -> UserView:
    roles = [UserRole(role) for role in user.roles]
    return UserView(
        name=user.name,
        roles=roles,
        disabled=user.disabled,
        is_from_provider=user.subject is not None,
        created=user.created,
        groups=user.groups,
    )
