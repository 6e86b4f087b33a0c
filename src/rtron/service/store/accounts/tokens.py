"""API tokens: `rtron_` and 256 random bits, for programs and guards."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from rtron.errors import InputError
from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.roles import AccessScope
from rtron.service.store.accounts.secrets import new_secret, secret_digest
from rtron.service.store.tables import TokenRow

PREFIX = "rtron_"
_DAY = 86_400_000_000_000
_MAX_TOKENS = 10_000


@dataclass(frozen=True, slots=True, kw_only=True)
class TokenSpec:
    """A token to make: `robot` belongs to the scope `guard` and to no other."""

    name: str
    scopes: Iterable[AccessScope]
    robot: str | None = None
    days: int | None = None

    def check(self) -> None:
        """Raise InputError for a guard of no robot, or a robot without a guard."""
        if (AccessScope.GUARD in self.scopes) != (self.robot is not None):
            help = "a token with the scope guard speaks for one robot, others for none"
            raise InputError("scope guard and robot belong together", help=help)
        if AccessScope.GUARD in self.scopes and len(set(self.scopes)) > 1:
            help = "make a second token"
            raise InputError("a guard's token is for nothing else", help=help)


def all_tokens(session: Session) -> Sequence[TokenRow]:
    """Return every token, by name."""
    return session.scalars(select(TokenRow).order_by(TokenRow.name)).all()


def create_token(session: Session, now: int, by: str, spec: TokenSpec) -> tuple[TokenRow, str]:
    """Make a token; return it and its secret. InputError, or ConflictError if the name is taken."""
    spec.check()
    if session.scalar(select(TokenRow.id).where(TokenRow.name == spec.name)):
        raise ConflictError(f"there is, or was, a token {spec.name} already")
    if len(all_tokens(session)) >= _MAX_TOKENS:
        raise ConflictError(f"there are {_MAX_TOKENS} tokens, no more are kept")
    secret = new_secret(PREFIX)
    row = TokenRow(
        name=spec.name,
        digest=secret_digest(secret),
        scopes=sorted(set(map(str, spec.scopes))),
        robot=spec.robot or "",
        by=by,
        created=now,
        expires=now + spec.days * _DAY if spec.days else None,
        revoked=None,
        used=None,
    )
    session.add(row)
    session.flush()
    return row, secret


def find_token(session: Session, now: int, secret: str) -> TokenRow | None:
    """Return the token of a secret, None if it is over or revoked."""
    row = session.scalar(select(TokenRow).where(TokenRow.digest == secret_digest(secret)))
    return row if row and is_valid(row, now) else None


def is_valid(token: TokenRow, now: int) -> bool:
    """Tell whether a token is neither revoked nor over."""
    return token.revoked is None and (token.expires is None or now < token.expires)


def revoke_token(session: Session, now: int, name: str) -> TokenRow:
    """Make a token worthless from now on; NotFoundError if there is none."""
    row = session.scalar(select(TokenRow).where(TokenRow.name == name))
    if row is None:
        raise NotFoundError(f"there is no token {name}")
    row.revoked = row.revoked or now
    return row


def find_guard_token(session: Session, now: int, secret: str) -> TokenRow | None:
    """Return the token of a robot's guard, None if the secret is that of none."""
    row = find_token(session, now, secret)
    return row if row and AccessScope.GUARD in row.scopes else None
