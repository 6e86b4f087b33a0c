"""API tokens: made and revoked by an admin."""

from typing import Any

from fastapi import APIRouter

from rtron.service.api.audit_transaction import audit_transaction
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import ServiceDependency
from rtron.service.api.schemas import CreatedToken, NewToken, TokenView
from rtron.service.domain.roles import AccessScope
from rtron.service.domain.schemas import Name
from rtron.service.store.accounts.tokens import TokenSpec, all_tokens, create_token, revoke_token
from rtron.service.store.tables import TokenRow

router = APIRouter(prefix="/tokens")


@router.get("")
def list_tokens(_caller: AdminOnly, service: ServiceDependency) -> list[TokenView]:
    """Return every token, by name, without its secret."""
    with service.database.session() as session:
        return [TokenView(**_view(token)) for token in all_tokens(session)]


@router.post("", status_code=201)
def create(new: NewToken, caller: AdminOnly, service: ServiceDependency) -> CreatedToken:
    """Make a token; its secret is told this once."""
    spec = TokenSpec(name=new.name, scopes=new.scopes, robot=new.robot, days=new.days)
    event = caller.audit_event(
        "create token", new.name, **new.model_dump(mode="json", exclude={"name"})
    )
    with audit_transaction(service, event) as session:
        token, secret = create_token(session, service.clock(), caller.name, spec)
        return CreatedToken(**_view(token), secret=secret)


@router.delete("/{token}", status_code=204)
def revoke(token: Name, caller: AdminOnly, service: ServiceDependency) -> None:
    """Revoke a token; it stays in the list."""
    with audit_transaction(service, caller.audit_event("revoke token", token)) as session:
        revoke_token(session, service.clock(), token)


def _view(token: TokenRow) -> dict[str, Any]:
    return {
        "name": token.name,
        "scopes": [AccessScope(scope) for scope in token.scopes],
        "robot": token.robot or None,
        "by": token.by,
        "created": token.created,
        "expires": token.expires,
        "revoked": token.revoked,
        "used": token.used,
    }
