"""API tokens: `rtron_` and 256 random bits, for programs and guards.

Until then both hold, so that an answer that was lost, or a disk that was full, locks nobody out. Of
several that renew one token at once one gets a secret: the file of another would hold a lost one.
The secret before is remembered: whoever shows it still may have stolen it (RFC 9700, 4.14.2).
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

from sqlalchemy import func, or_, select, update
from sqlalchemy.orm import Session

from rtron.errors import InputError
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock
from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.principal import AccessScope, check_group_limit
from rtron.service.store.accounts.last_use import record_use, record_uses, try_update
from rtron.service.store.accounts.random_secrets import new_secret, secret_digest
from rtron.service.store.audit import record_event, record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.notices import TokensNotice, post_notice
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


_MAX_TOKENS = 10_000


@dataclass(frozen=True, slots=True, kw_only=True)
class TokenSpec:
    """A token to make: `robot` belongs to the scope `guard` and to no other.

    Of the robots, it may change those of `groups`; None: all.
    """

    name: str
    scopes: Iterable[AccessScope]
    robot: str | None = None
    days: int = DEFAULT_DAYS
    groups: Collection[str] | None = None

    def check(self) -> None:
        """Raise InputError for a guard of no robot, or a robot without a guard."""
        if (AccessScope.GUARD in self.scopes) != (self.robot is not None):
            help = "a token with the scope guard speaks for one robot, others for none"
            raise InputError("scope guard and robot belong together", help=help)
        if AccessScope.GUARD in self.scopes and len(set(self.scopes)) > 1:
            help = "make a second token"
            raise InputError("a guard's token is for nothing else", help=help)
        check_group_limit(self.groups, list(self.scopes))


def all_tokens(session: Session) -> Sequence[TokenRow]:
    """Return every token, by name."""
    return session.scalars(select(TokenRow).order_by(TokenRow.name)).all()


def create_token(session: Session, now: int, by: str, spec: TokenSpec) -> tuple[TokenRow, str]:
    """Make a token; return it and its secret. InputError, or ConflictError if the name is taken."""
    secret = new_secret(TOKEN_PREFIX)
    return add_token(session, now, by, spec, secret_digest(secret)), secret


def add_token(session: Session, now: int, by: str, spec: TokenSpec, digest: str) -> TokenRow:
    """Add a token whose secret has this digest. InputError, or ConflictError if it is there."""
    spec.check()
    if session.scalar(select(TokenRow.id).where(TokenRow.name == spec.name)):
        raise ConflictError(f"there is, or was, a token {spec.name} already")
    if session.scalars(select(func.count()).select_from(TokenRow)).one() >= _MAX_TOKENS:
        raise ConflictError(f"there are {_MAX_TOKENS} tokens, no more are kept")
    lifetime = spec.days * DAY
    row = TokenRow(
        name=spec.name,
        digest=digest,
        scopes=sorted(set(map(str, spec.scopes))),
        robot=spec.robot or "",
        by=by,
        created=now,
        expires=now + lifetime,
        lifetime=lifetime,
        revoked=None,
        used=None,
        groups=None if spec.groups is None else sorted(set(spec.groups)),
    )
    session.add(row)
    session.flush()
    return row


def find_token(session: Session, now: int, secret: str) -> TokenRow | None:
    """Return the token of a secret, also of the one it gets next; None if it is over or revoked."""
    digest = secret_digest(secret)
    is_same = or_(TokenRow.digest == digest, TokenRow.next_digest == digest)
    row = session.scalar(select(TokenRow).where(is_same))
    return row if row and is_valid(row, now) else None


def valid_digests(session: Session, now: int, digests: Collection[str]) -> Collection[str]:
    """Return the digests of tokens that are neither revoked nor over."""
    is_held = or_(TokenRow.expires.is_(None), TokenRow.expires > now)
    query = select(TokenRow.digest, TokenRow.next_digest)
    rows = session.execute(query.where(TokenRow.revoked.is_(None), is_held))
    return {digest for row in rows for digest in row} & set(digests)


def is_valid(token: TokenRow, now: int) -> bool:
    """Tell whether a token is neither revoked nor over."""
    return token.revoked is None and (token.expires is None or now < token.expires)


def revoke_token(session: Session, now: int, name: str) -> TokenRow:
    """Make a token worthless from now on; NotFoundError if there is none."""
    row = session.scalar(select(TokenRow).where(TokenRow.name == name))
    if row is None:
        raise NotFoundError(f"there is no token {name}")
    row.revoked = row.revoked or now
    post_notice(session, TokensNotice())
    return row


def find_guard_token(session: Session, now: int, secret: str) -> TokenRow | None:
    """Return the token of a robot's guard, None if the secret is that of none."""
    row = find_token(session, now, secret)
    return row if row and AccessScope.GUARD in row.scopes else None


_USE_INTERVAL = 60 * SECOND


@dataclass(slots=True)
class GuardTokens:
    """Looks tokens up in the database, and notes that they are used; both are called in threads."""

    database: Database
    clock: Clock
    _used: int = field(default=0, init=False)

    def authenticate(self, secret: str) -> str | None:
        """Return the robot that a token speaks for, or None."""
        now = self.clock()
        with self.database.session() as session:
            token = find_guard_token(session, now, secret)
        if token is None:
            record_replaced_secret(self.database, now, secret)
            return None
        promote_secret(self.database, token, now, secret)
        record_use(self.database, token, now)
        return token.robot

    def find_valid(self, secrets: Collection[str]) -> Collection[str]:
        """Return the tokens that still hold; all of them in one query."""
        now = self.clock()
        digests = {secret_digest(secret): secret for secret in secrets}
        with self.database.session() as session:
            valid = valid_digests(session, now, digests.keys())
        if abs(now - self._used) >= _USE_INTERVAL:
            self._used = now
            record_uses(self.database, valid, now)
        return {digests[digest] for digest in valid}

    def find_due(self, secrets: Collection[str]) -> Collection[str]:
        """Return the tokens that are to be renewed."""
        digests = {secret_digest(secret): secret for secret in secrets}
        with self.database.session() as session:
            return {digests[each] for each in due_digests(session, self.clock(), digests.keys())}

    def renew(self, secret: str) -> str | None:
        """Return the next secret of a token, which holds beside the first.

        None if that is over; ConflictError if another connection has just got one.
        """
        now = self.clock()
        with self.database.write_session() as session:
            token = find_guard_token(session, now, secret)
            if token is None:
                return None
            renewed = renew_token(session, now, secret)
            event = AuditEvent(who=f"token:{token.name}", action="renew token", target=token.name)
            record_event(session, now, event)
            return renewed

    def promote(self, secret: str) -> None:
        """Let a next secret replace the one before: its guard has it on disk."""
        now = self.clock()
        with self.database.session() as session:
            token = find_guard_token(session, now, secret)
        if token is not None:
            promote_secret(self.database, token, now, secret)
