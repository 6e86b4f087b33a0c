"""Users: who may log in, and as what. The last admin who can log in stays."""

from collections.abc import Iterable, Sequence

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.roles import UserRole
from rtron.service.store.accounts.logins import end_sessions
from rtron.service.store.tables import UserRow

_MAX_USERS = 1000


def all_users(session: Session) -> Sequence[UserRow]:
    """Return every user, by name."""
    return session.scalars(select(UserRow).order_by(UserRow.name)).all()


def find_user(session: Session, name: str) -> UserRow | None:
    """Return the user of a name, if there is one."""
    return session.scalar(select(UserRow).where(UserRow.name == name))


def get_user(session: Session, name: str) -> UserRow:
    """Return the user of a name; NotFoundError if there is none."""
    if user := find_user(session, name):
        return user
    raise NotFoundError(f"there is no user {name}")


def add_user(
    session: Session, now: int, name: str, password_hash: str, roles: Iterable[UserRole]
) -> UserRow:
    """Add a user; ConflictError if the name is taken."""
    if find_user(session, name):
        raise ConflictError(f"there is a user {name} already")
    if len(all_users(session)) >= _MAX_USERS:
        raise ConflictError(f"there are {_MAX_USERS} users, no more are kept")
    user = UserRow(
        name=name,
        password_hash=password_hash,
        roles=_role_names(roles),
        disabled=False,
        created=now,
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
    session.delete(user)


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
