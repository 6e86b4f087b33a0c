"""API tokens: made and revoked by an admin."""

from typing import Any

from fastapi import APIRouter

from rtron.service.api.audit_transaction import audited
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import Served
from rtron.service.domain.schemas import CreatedToken, Name, NewToken, Scope, TokenView
from rtron.service.store.accounts.tokens import TokenWish, all_tokens, create_token, revoke_token
from rtron.service.store.tables import TokenRow

router = APIRouter(prefix="/tokens")


@router.get("")
def list_tokens(_caller: AdminOnly, service: Served) -> list[TokenView]:
    """Return every token, by name, without its secret."""
    with service.database.session() as session:
        return [TokenView(**_view(token)) for token in all_tokens(session)]


@router.post("", status_code=201)
def new_token(new: NewToken, caller: AdminOnly, service: Served) -> CreatedToken:
    """Make a token; its secret is told this once."""
    wish = TokenWish(name=new.name, scopes=new.scopes, robot=new.robot, days=new.days)
    deed = caller.deed("create token", new.name, **new.model_dump(mode="json", exclude={"name"}))
    with audited(service, deed) as session:
        token, secret = create_token(session, service.clock(), caller.name, wish)
        return CreatedToken(**_view(token), secret=secret)


@router.delete("/{token}", status_code=204)
def end_token(token: Name, caller: AdminOnly, service: Served) -> None:
    """Revoke a token; it stays in the list."""
    with audited(service, caller.deed("revoke token", token)) as session:
        revoke_token(session, service.clock(), token)


def _view(token: TokenRow) -> dict[str, Any]:
    return {
        "name": token.name,
        "scopes": [Scope(scope) for scope in token.scopes],
        "robot": token.robot or None,
        "by": token.by,
        "created": token.created,
        "expires": token.expires,
        "revoked": token.revoked,
        "used": token.used,
    }
