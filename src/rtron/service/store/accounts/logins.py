"""Logins in a browser: a session begins with a password, and ends by time or by request."""

from dataclasses import dataclass

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.roles import SessionStage
from rtron.service.store.accounts.secrets import new_secret, secret_digest
from rtron.service.store.tables import SessionRow, UserRow
from rtron.vocabulary import SECOND

_MAX_SESSIONS = 20
_INCOMPLETE_LIFETIME = 600 * SECOND
"""So long a session may wait for its second factor."""


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
    session: Session,
    now: int,
    user: UserRow,
    lifetime: SessionLifetime,
    stage: SessionStage = SessionStage.COMPLETE,
) -> NewSession:
    """Begin a session with a secret of its own; those that are over, or too many, are removed.

    Those that wait for a code are not counted: who has only the password ends nobody's session.
    """
    _delete_expired(session, now, lifetime)
    if stage == SessionStage.COMPLETE:
        _delete_excess(session, user.id)
    login = NewSession(secret=new_secret(), csrf=new_secret())
    row = SessionRow(
        digest=secret_digest(login.secret),
        user_id=user.id,
        csrf=login.csrf,
        stage=stage,
        created=now,
        used=now,
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


def began_within(session: Session, now: int, hashed: str, duration: int) -> bool:
    """Tell whether a session began in the last `duration` (ns)."""
    created = session.scalar(select(SessionRow.created).where(SessionRow.digest == hashed))
    return created is not None and 0 <= now - created <= duration


def renew_secret(session: Session, hashed: str) -> str:
    """Give a session another secret, whoever has the one before; return it."""
    secret = new_secret()
    is_same = SessionRow.digest == hashed
    session.execute(update(SessionRow).where(is_same).values(digest=secret_digest(secret)))
    return secret


def end_session(session: Session, hashed: str) -> None:
    """End the session of a digest, if there is one."""
    session.execute(delete(SessionRow).where(SessionRow.digest == hashed))


def end_sessions(session: Session, user_id: int, except_digest: str = "") -> None:
    """End all sessions of a user but the one whose digest is `except_digest`."""
    is_users = SessionRow.user_id == user_id
    session.execute(delete(SessionRow).where(is_users, SessionRow.digest != except_digest))


def _is_expired(login: SessionRow, now: int, lifetime: SessionLifetime) -> bool:
    is_incomplete = login.stage != SessionStage.COMPLETE
    maximum = min(lifetime.maximum, _INCOMPLETE_LIFETIME) if is_incomplete else lifetime.maximum
    return now - login.used > lifetime.idle or now - login.created > maximum


def _delete_expired(session: Session, now: int, lifetime: SessionLifetime) -> None:
    is_idle = SessionRow.used < now - lifetime.idle
    is_old = SessionRow.created < now - lifetime.maximum
    is_incomplete = SessionRow.stage != SessionStage.COMPLETE
    is_given_up = is_incomplete & (SessionRow.created < now - _INCOMPLETE_LIFETIME)
    session.execute(delete(SessionRow).where(is_idle | is_old | is_given_up))


def _delete_excess(session: Session, user_id: int) -> None:
    is_complete = SessionRow.stage == SessionStage.COMPLETE
    query = select(SessionRow.digest).where(SessionRow.user_id == user_id, is_complete)
    digests = session.scalars(
        query.order_by(SessionRow.used.desc()).offset(_MAX_SESSIONS - 1)
    ).all()
    session.execute(delete(SessionRow).where(SessionRow.digest.in_(digests)))
