"""Putting changes of rights in force, and keeping those that wait for a second admin."""

from collections.abc import Sequence
from secrets import randbelow

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from rtron.service.domain.account_changes import (
    CHANGES,
    AccountChange,
    AddUser,
    ChangeUser,
    CreateToken,
    FormGroup,
    LabelRobot,
    gives_rights,
)
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.store.accounts.logins import end_sessions
from rtron.service.store.accounts.second_factors import changes_one, remove_second_factor
from rtron.service.store.accounts.tokens import TokenSpec, add_token
from rtron.service.store.accounts.users import (
    add_user,
    find_user,
    get_user,
    roles_of,
    set_disabled,
    set_groups,
    set_password,
    set_roles,
)
from rtron.service.store.fleet.labels import labels_of, replace_labels, replace_members
from rtron.service.store.robots import RobotFilter, find_robot, list_robots
from rtron.service.store.tables import PendingChangeRow, RobotRow, TokenRow, UserRow

_MAX_PENDING = 200
_LIFETIME = 7 * 86_400_000_000_000
"""A change that nobody has approved by then, ns, is over."""
_MAX_ID = (1 << 53) - 1
"""Up to here browsers read whole numbers as they are."""


def apply_change(
    session: Session, now: int, by: str, change: AccountChange
) -> UserRow | TokenRow | None:
    """Put a change in force, as `by` asked for it; ConflictError if it does not fit any more."""
    if isinstance(change, (LabelRobot, FormGroup)):
        _change_labels(session, change)
        return None
    if isinstance(change, AddUser):
        user = add_user(session, now, change.name, change.password_hash, change.roles)
        set_groups(user, change.groups)
        return user
    if isinstance(change, CreateToken):
        spec = TokenSpec(
            name=change.name,
            scopes=change.scopes,
            robot=change.robot,
            days=change.days,
            groups=change.groups,
        )
        return add_token(session, now, by, spec, change.digest)
    user = get_user(session, change.name)
    if isinstance(change, ChangeUser):
        _change_user(session, user, change)
    else:
        remove_second_factor(session, user)
        end_sessions(session, user.id)
    return user


def needs_approval(session: Session, change: AccountChange) -> bool:
    """Tell whether a change gives rights; NotFoundError if its user or robot is not there."""
    if isinstance(change, ChangeUser):
        user = get_user(session, change.name)
        return gives_rights(change, roles_of(user), user.groups, is_disabled=user.disabled)
    if isinstance(change, LabelRobot):
        return gives_rights(change, members=labels_of(session, _get_robot(session, change).name))
    if isinstance(change, FormGroup):
        robots = list_robots(session, RobotFilter(label=change.name))
        return gives_rights(change, members=[robot.name for robot, _ in robots])
    return gives_rights(change)


def request_approval(
    session: Session, now: int, by: str, change: AccountChange
) -> PendingChangeRow:
    """Let a change wait for a second admin; ConflictError if too many wait.

    ForbiddenError for a token that no user has created: its holder could be the second one too.
    Its id is random. SQLite gives a deleted row's id away again, so that somebody could approve
    another change than the one that was shown.
    """
    session.execute(delete(PendingChangeRow).where(PendingChangeRow.expires <= now))
    if session.scalars(select(func.count()).select_from(PendingChangeRow)).one() >= _MAX_PENDING:
        raise ConflictError(f"{_MAX_PENDING} changes wait", help="approve or reject some first")
    owner = find_user(session, _owner(session, by))
    if owner is None:
        help = "create it in the console, or ask as a user"
        raise ForbiddenError(f"nobody knows whose token {by.removeprefix('token:')} is", help=help)
    row = PendingChangeRow(
        id=1 + randbelow(_MAX_ID),
        change=change.model_dump(mode="json"),
        by=by,
        owner=owner.name,
        created=now,
        expires=now + _LIFETIME,
    )
    session.add(row)
    session.flush()
    return row


def pending_changes(session: Session, now: int) -> Sequence[PendingChangeRow]:
    """Return the changes that wait, the oldest first."""
    query = select(PendingChangeRow).where(PendingChangeRow.expires > now)
    return session.scalars(query.order_by(PendingChangeRow.created, PendingChangeRow.id)).all()


def take_pending(session: Session, now: int, id: int) -> PendingChangeRow:
    """Return a change that waits, which waits no more; NotFoundError if somebody was faster."""
    query = select(PendingChangeRow).where(
        PendingChangeRow.id == id, PendingChangeRow.expires > now
    )
    row = session.scalar(query)
    removal = delete(PendingChangeRow).where(PendingChangeRow.id == id)
    if row is None or not changes_one(session, removal):
        raise NotFoundError(f"no change {id} waits", help="somebody was faster, or it is over")
    return row


def change_of(row: PendingChangeRow) -> AccountChange:
    """Return the change that a row keeps."""
    return CHANGES.validate_python(row.change)


def _change_user(session: Session, user: UserRow, change: ChangeUser) -> None:
    if user.subject and (change.password_hash or change.roles is not None):
        help = "change them at the provider, or disable the user here"
        raise ConflictError(f"{user.name} has password and roles from the provider", help=help)
    if change.password_hash:
        set_password(session, user, change.password_hash)
    if change.roles is not None:
        set_roles(session, user, change.roles)
    if change.has_all_robots or change.groups is not None or change.roles is not None:
        groups = user.groups if change.groups is None else change.groups
        set_groups(user, None if change.has_all_robots else groups)
    if change.disabled is not None:
        set_disabled(session, user, disabled=change.disabled)


def _change_labels(session: Session, change: LabelRobot | FormGroup) -> None:
    if isinstance(change, LabelRobot):
        return replace_labels(session, _get_robot(session, change), change.labels)
    found = list_robots(session, RobotFilter(within=change.robots))
    if missing := change.robots - {robot.name for robot, _ in found}:
        raise NotFoundError(f"there is no robot {min(missing)}")
    return replace_members(session, change.name, [robot.id for robot, _ in found])


def _get_robot(session: Session, change: LabelRobot) -> RobotRow:
    match = find_robot(session, change.name)
    if match is None:
        raise NotFoundError("there is no such robot", help="GET /api/v1/robots lists them")
    return match[0]


def _owner(session: Session, by: str) -> str:
    """Return the person behind who asks: of a token, who has created it."""
    if not by.startswith("token:"):
        return by
    query = select(TokenRow.by).where(TokenRow.name == by.removeprefix("token:"))
    creator = session.scalar(query) or by
    return _owner(session, creator) if creator != by else by
