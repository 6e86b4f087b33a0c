"""Logins in a browser: a session begins with a password, and ends by time or by request."""

from dataclasses import dataclass

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from rtron.service.store.accounts.secrets import new_secret, secret_digest
from rtron.service.store.tables import SessionRow, UserRow

_MAX_SESSIONS = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionLifetime:
    """How long a session lasts without being used, and at most; ns."""

    idle: int
    maximum: int


@dataclass(frozen=True, slots=True, kw_only=True)
class NewSession:
    """What the browser gets: the secret of its cookie, and the CSRF token for its requests."""

    secret: str
    csrf: str


def begin_session(
    session: Session, now: int, user: UserRow, lifetime: SessionLifetime
) -> NewSession:
    """Begin a session with a secret of its own; those that are over, or too many, are removed."""
    _delete_expired(session, now, lifetime)
    _delete_excess(session, user.id)
    login = NewSession(secret=new_secret(), csrf=new_secret())
    row = SessionRow(
        digest=secret_digest(login.secret), user_id=user.id, csrf=login.csrf, created=now, used=now
    )
    session.add(row)
    return login


def find_session(
    session: Session, now: int, hashed: str, lifetime: SessionLifetime
) -> tuple[SessionRow, UserRow] | None:
    """Return the session of a digest and its user, None if it is over."""
    query = select(SessionRow, UserRow).join(UserRow, UserRow.id == SessionRow.user_id)
    match = session.execute(query.where(SessionRow.digest == hashed)).first()
    if not match:
        return None
    login, user = match
    if user.disabled or _is_expired(login, now, lifetime):
        return None
    return login, user


def end_session(session: Session, hashed: str) -> None:
    """End the session of a digest, if there is one."""
    session.execute(delete(SessionRow).where(SessionRow.digest == hashed))


def end_sessions(session: Session, user_id: int, except_digest: str = "") -> None:
    """End all sessions of a user but the one whose digest is `except_digest`."""
    is_users = SessionRow.user_id == user_id
    session.execute(delete(SessionRow).where(is_users, SessionRow.digest != except_digest))


def _is_expired(login: SessionRow, now: int, lifetime: SessionLifetime) -> bool:
    return now - login.used > lifetime.idle or now - login.created > lifetime.maximum


def _delete_expired(session: Session, now: int, lifetime: SessionLifetime) -> None:
    idle = SessionRow.used < now - lifetime.idle
    session.execute(delete(SessionRow).where(idle | (SessionRow.created < now - lifetime.maximum)))


def _delete_excess(session: Session, user_id: int) -> None:
    query = select(SessionRow.digest).where(SessionRow.user_id == user_id)
    digests = session.scalars(
        query.order_by(SessionRow.used.desc()).offset(_MAX_SESSIONS - 1)
    ).all()
    session.execute(delete(SessionRow).where(SessionRow.digest.in_(digests)))
