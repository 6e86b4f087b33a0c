"""Users: who may log in, and as what. The last admin who can log in stays."""

from collections.abc import Collection, Iterable, Sequence

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.oidc import ProviderUser, SignInError, SignInProblem
from rtron.service.domain.principal import UserRole, check_group_limit
from rtron.service.store.accounts.logins import end_sessions, forget_browsers
from rtron.service.store.accounts.random_secrets import secret_digest
from rtron.service.store.accounts.second_factors import remove_second_factor
from rtron.service.store.tables import UserRow

_MAX_USERS = 1000
SERVICE_NAME = "rtron"
"""So the service calls itself in the audit log; no user is called that."""


def all_users(session: Session) -> Sequence[UserRow]:
    """Return every user, by name."""
    return session.scalars(select(UserRow).order_by(UserRow.name)).all()


def find_user(session: Session, name: str) -> UserRow | None:
    """Return the user of a name, if there is one."""
    return session.scalar(select(UserRow).where(UserRow.name == name))


def is_taken(session: Session, name: str) -> bool:
    """Tell whether a name is a user's, or the service's own, in capital or small letters."""
    small = name.lower()
    is_same = func.lower(UserRow.name) == small
    return small == SERVICE_NAME or session.scalar(select(UserRow.id).where(is_same)) is not None


def get_user(session: Session, name: str) -> UserRow:
    """Return the user of a name; NotFoundError if there is none."""
    if user := find_user(session, name):
        return user
    raise NotFoundError(f"there is no user {name}")


def add_user(
    session: Session, now: int, name: str, password_hash: str, roles: Iterable[UserRole]
) -> UserRow:
    """Add a user; ConflictError if the name is taken."""
    if is_taken(session, name):
        raise ConflictError(f"there is a user {name} already")
    if len(all_users(session)) >= _MAX_USERS:
        raise ConflictError(f"there are {_MAX_USERS} users, no more are kept")
    user = UserRow(
        name=name,
        password_hash=password_hash,
        roles=_role_names(roles),
        disabled=False,
        created=now,
        groups=None,
    )
    session.add(user)
    session.flush()
    return user


def set_password(
    session: Session, user: UserRow, password_hash: str, except_session: str = ""
) -> None:
    """Set a password; end the user's sessions but the one with the digest `except_session`."""
    user.password_hash = password_hash
    end_sessions(session, user.id, except_session)


def set_roles(session: Session, user: UserRow, roles: Iterable[UserRole]) -> None:
    """Set the roles and end the user's sessions; ConflictError if no admin would be left."""
    role_names = _role_names(roles)
    if UserRole.ADMIN not in role_names:
        _check_admin_remains(session, user)
    user.roles = role_names
    end_sessions(session, user.id)


def set_groups(user: UserRow, groups: Collection[str] | None) -> None:
    """Limit what a user may change to the robots of groups; None: all. InputError for an admin."""
    check_group_limit(groups, roles_of(user))
    user.groups = None if groups is None else sorted(set(groups))


def set_disabled(session: Session, user: UserRow, *, disabled: bool) -> None:
    """Let a user log in no more, or again; ConflictError if no admin would be left."""
    if disabled:
        _check_admin_remains(session, user)
        end_sessions(session, user.id)
    user.disabled = disabled


def remove_user(session: Session, user: UserRow) -> None:
    """Remove a user; ConflictError if no admin would be left."""
    _check_admin_remains(session, user)
    end_sessions(session, user.id)
    remove_second_factor(session, user)
    forget_browsers(session, user)
    session.delete(user)


def sign_in(session: Session, now: int, signed_in: ProviderUser, unusable_password: str) -> UserRow:
    """Return the user, added at the first time, with what the provider gives now.

    SignInError for who has no role, is disabled, or has the name of somebody else here.
    """
    user = _find_provider_user(session, signed_in.subject)
    if user is None:
        user = _add_provider_user(session, now, signed_in, unusable_password)
    if user.disabled:
        raise SignInError(SignInProblem.DISABLED)
    roles = sorted(map(str, signed_in.roles))
    if user.roles != roles:
        end_sessions(session, user.id)
        user.roles = roles
    if signed_in.groups is not None:
        user.groups = None if UserRole.ADMIN in roles else sorted(signed_in.groups)
    return user


def withdraw_roles(session: Session, subject: str) -> None:
    """Take what a user had whom the provider gives no role any more; the sessions end."""
    if user := _find_provider_user(session, subject):
        user.roles = []
        end_sessions(session, user.id)


def roles_of(user: UserRow) -> frozenset[UserRole]:
    """Return what a user is."""
    return frozenset(map(UserRole, user.roles))


def _check_admin_remains(session: Session, user: UserRow) -> None:
    """Two admins must not take each other's role away at once: one write goes before the look."""
    first = select(func.min(UserRow.id)).scalar_subquery()
    session.execute(update(UserRow).where(UserRow.id == first).values(created=UserRow.created))
    others = select(UserRow.roles).where(UserRow.id != user.id, UserRow.disabled.is_(False))
    if not any(UserRole.ADMIN in roles for roles in session.scalars(others)):
        raise ConflictError(
            f"{user.name} is the last admin", help="give another user the role admin first"
        )


def _role_names(roles: Iterable[UserRole]) -> list[str]:
    return sorted(set(map(str, roles)))


def _find_provider_user(session: Session, subject: str) -> UserRow | None:
    """Return the user of a subject, who has signed in before."""
    return session.scalar(select(UserRow).where(UserRow.subject == secret_digest(subject)))


def _add_provider_user(
    session: Session, now: int, signed_in: ProviderUser, unusable_password: str
) -> UserRow:
    if is_taken(session, signed_in.name):
        raise SignInError(SignInProblem.NAME_TAKEN)
    user = add_user(session, now, signed_in.name, unusable_password, signed_in.roles)
    user.subject = secret_digest(signed_in.subject)
    return user
