"""Browsers in which users have logged in: what others guess does not delay a login in them.

Their cookie is no login, and takes nobody's password away; it only says that this is not one of the
guessers' browsers (OWASP, "Slow Down Online Guessing Attacks with Device Cookies").
"""

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from rtron.service.store.accounts.secrets import new_secret, secret_digest
from rtron.service.store.tables import KnownBrowserRow, UserRow

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
