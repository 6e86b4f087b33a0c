"""Logins in a browser: a session begins with a password, and ends by time or by request."""

from dataclasses import dataclass

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from rtron.service.store.accounts.secrets import digest, new_secret
from rtron.service.store.tables import SessionRow, UserRow

_MOST = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Lifetime:
    """How long a session lasts without being used, and at most; ns."""

    idle: int
    longest: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NewLogin:
    """What the browser gets: the secret of its cookie, and the CSRF token for its requests."""

    secret: str
    csrf: str


def begin_login(session: Session, now: int, user: UserRow, lifetime: Lifetime) -> NewLogin:
    """Begin a session with a secret of its own; those that are over, or too many, are removed."""
    _remove_old(session, now, lifetime)
    _make_room(session, user.id)
    login = NewLogin(secret=new_secret(), csrf=new_secret())
    row = SessionRow(
        digest=digest(login.secret), user_id=user.id, csrf=login.csrf, created=now, used=now
    )
    session.add(row)
    return login


def find_login(
    session: Session, now: int, hashed: str, lifetime: Lifetime
) -> tuple[SessionRow, UserRow] | None:
    """Return the session of a digest and its user, None if it is over."""
    query = select(SessionRow, UserRow).join(UserRow, UserRow.id == SessionRow.user_id)
    found = session.execute(query.where(SessionRow.digest == hashed)).first()
    if not found:
        return None
    login, user = found
    if user.disabled or _is_over(login, now, lifetime):
        return None
    return login, user


def end_login(session: Session, hashed: str) -> None:
    """End the session of a digest, if there is one."""
    session.execute(delete(SessionRow).where(SessionRow.digest == hashed))


def end_logins(session: Session, user_id: int, keep: str = "") -> None:
    """End all sessions of a user but the one whose digest is `keep`."""
    own = SessionRow.user_id == user_id
    session.execute(delete(SessionRow).where(own, SessionRow.digest != keep))


def _is_over(login: SessionRow, now: int, lifetime: Lifetime) -> bool:
    return now - login.used > lifetime.idle or now - login.created > lifetime.longest


def _remove_old(session: Session, now: int, lifetime: Lifetime) -> None:
    idle = SessionRow.used < now - lifetime.idle
    session.execute(delete(SessionRow).where(idle | (SessionRow.created < now - lifetime.longest)))


def _make_room(session: Session, user_id: int) -> None:
    query = select(SessionRow.digest).where(SessionRow.user_id == user_id)
    digests = session.scalars(query.order_by(SessionRow.used.desc()).offset(_MOST - 1)).all()
    session.execute(delete(SessionRow).where(SessionRow.digest.in_(digests)))
