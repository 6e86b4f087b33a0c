"""Logins in a browser: a session begins with a password, and ends by time or by request.

Their cookie is no login, and takes nobody's password away; it only says that this is not one of the
guessers' browsers (OWASP, "Slow Down Online Guessing Attacks with Device Cookies").
"""

from dataclasses import dataclass

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.principal import SessionStage
from rtron.service.store.accounts.random_secrets import new_secret, secret_digest
from rtron.service.store.tables import KnownBrowserRow, SessionRow, UserRow
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


MAX_AGE_S = 180 * 86_400
_MAX_AGE = MAX_AGE_S * 1_000_000_000
_MAX_BROWSERS = 20


def find_known_browser(session: Session, now: int, name: str, secret: str) -> str:
    """Return the digest of the browser's secret if this user has logged in there, else ""."""
    digest = secret_digest(secret)
    query = select(KnownBrowserRow.digest).join(UserRow, UserRow.id == KnownBrowserRow.user_id)
    is_young = KnownBrowserRow.created > now - _MAX_AGE
    is_same = KnownBrowserRow.digest == digest
    return session.scalar(query.where(is_same, is_young, UserRow.name == name)) or ""


def is_anybodys_browser(session: Session, now: int, secret: str) -> bool:
    """Tell whether any user has logged in in the browser with this secret."""
    is_young = KnownBrowserRow.created > now - _MAX_AGE
    is_same = KnownBrowserRow.digest == secret_digest(secret)
    return session.scalar(select(KnownBrowserRow.digest).where(is_same, is_young)) is not None


def remember_browser(session: Session, now: int, user: UserRow) -> str:
    """Let a user's browser be known; return its secret. Those that are old, or too many, go."""
    secret = new_secret()
    session.add(KnownBrowserRow(digest=secret_digest(secret), user_id=user.id, created=now))
    session.flush()
    query = select(KnownBrowserRow.digest).where(KnownBrowserRow.user_id == user.id)
    newest = query.order_by(KnownBrowserRow.created.desc(), KnownBrowserRow.digest)
    excess = session.scalars(newest.offset(_MAX_BROWSERS)).all()
    is_old = KnownBrowserRow.created <= now - _MAX_AGE
    session.execute(delete(KnownBrowserRow).where(is_old | KnownBrowserRow.digest.in_(excess)))
    return secret


def forget_browsers(session: Session, user: UserRow) -> None:
    """Know none of a user's browsers any more."""
    session.execute(delete(KnownBrowserRow).where(KnownBrowserRow.user_id == user.id))
