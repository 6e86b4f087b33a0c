"""Renewal of tokens: a second secret, which replaces the first one when it is first used.

Until then both hold, so that an answer that was lost, or a disk that was full, locks nobody out. Of
several that renew one token at once one gets a secret: the file of another would hold a lost one.
The secret before is remembered: whoever shows it still may have stolen it (RFC 9700, 4.14.2).
"""

from collections.abc import Collection

from sqlalchemy import func, or_, select, update
from sqlalchemy.orm import Session

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import ConflictError
from rtron.service.store.accounts.last_use import try_update
from rtron.service.store.accounts.secrets import new_secret, secret_digest
from rtron.service.store.audit import record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.tables import TokenRow
from rtron.vocabulary import SECOND

TOKEN_PREFIX = "rtron_"  # noqa: S105 - what every token begins with
DAY = 86_400_000_000_000
DEFAULT_DAYS = 90
"""A token lasts so long, unless it is asked for another time; and as long again when renewed."""
OFFER_TIME = 60 * SECOND
"""So long after a next secret was made no other one is made: it may be about to be stored."""
_PLAIN = {"synchronize_session": False}
_LAST_PART = 3
"""A guard's token is renewed when a third of its lifetime is left."""


def lifetime_of(token: TokenRow) -> int:
    """Return how long a token lasts once it is renewed, ns."""
    return token.lifetime or DEFAULT_DAYS * DAY


def renew_token(session: Session, now: int, secret: str) -> str:
    """Return the next secret of the token with this one, in place of a next one that was not used.

    ConflictError if somebody else has got one less than `OFFER_TIME` before `now` (ns), or the
    token has another secret meanwhile.
    """
    renewed, made = new_secret(TOKEN_PREFIX), TokenRow.next_created
    is_free = or_(TokenRow.next_digest.is_(None), made.is_(None), made <= now - OFFER_TIME)
    change = update(TokenRow).where(
        TokenRow.digest == secret_digest(secret),
        or_(is_free, made > now),  # the clock was set back
    )
    values = {"next_digest": secret_digest(renewed), "next_created": now}
    changed = session.execute(
        change.values(values).returning(TokenRow.id), execution_options=_PLAIN
    )
    if changed.first() is None:
        help = f"if nobody stores that secret, try again after {OFFER_TIME // SECOND} s"
        raise ConflictError("the token is being renewed by somebody else", help=help)
    return renewed


def promote_secret(database: Database, token: TokenRow, now: int, secret: str) -> None:
    """Let a next secret that is used replace the one before; if the database fails, later."""
    digest = secret_digest(secret)
    if token.next_digest != digest:
        return
    lifetime = func.coalesce(TokenRow.lifetime, DEFAULT_DAYS * DAY)
    change = update(TokenRow).where(TokenRow.next_digest == digest)
    try_update(
        database,
        change.values(
            previous_digest=TokenRow.digest,
            digest=digest,
            next_digest=None,
            next_created=None,
            expires=now + lifetime,
            lifetime=lifetime,
        ),
    )


def record_replaced_secret(database: Database, now: int, secret: str, address: str = "") -> None:
    """Note in the audit log that somebody shows the secret that a token had before its renewal."""
    query = select(TokenRow.name).where(TokenRow.previous_digest == secret_digest(secret))
    with database.session() as session:
        name = session.scalar(query)
        if name:
            event = AuditEvent(
                who=f"token:{name}", action="use token", target=name, address=address
            )
            outcome = "refused: the secret before the renewal, which may be stolen"
            record_repeatable(session, now, event, outcome)


def due_digests(session: Session, now: int, digests: Collection[str]) -> Collection[str]:
    """Return the digests of tokens that hold, but not for long: they are to be renewed."""
    is_due = TokenRow.expires - TokenRow.lifetime / _LAST_PART <= now
    query = select(TokenRow.digest).where(
        TokenRow.revoked.is_(None), TokenRow.expires > now, is_due
    )
    return set(session.scalars(query)) & set(digests)
