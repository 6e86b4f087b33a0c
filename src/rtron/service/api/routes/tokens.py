"""API tokens: made and revoked by an admin."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response

from rtron.service.api.account_change_requests import change_account
from rtron.service.api.auth.authentication import bearer_secret
from rtron.service.api.auth.authorization import AdminOnly, TokenHolder
from rtron.service.api.context import ServiceDependency, audit_transaction
from rtron.service.api.schemas import (
    CreatedToken,
    NewToken,
    PendingChangeView,
    PendingToken,
    TokenView,
)
from rtron.service.domain.account_changes import CreateToken
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.principal import AccessScope
from rtron.service.domain.schemas import Name
from rtron.service.store.accounts.random_secrets import new_secret, secret_digest
from rtron.service.store.accounts.tokens import (
    TOKEN_PREFIX,
    TokenSpec,
    all_tokens,
    find_token,
    lifetime_of,
    renew_token,
    revoke_token,
)
from rtron.service.store.tables import TokenRow

router = APIRouter(prefix="/tokens")


@router.get("")
def list_tokens(_caller: AdminOnly, service: ServiceDependency) -> list[TokenView]:
    """Return every token, by name, without its secret."""
    with service.database.session() as session:
        return [TokenView(**_view(token)) for token in all_tokens(session)]


@router.post("", status_code=201)
def create(
    new: NewToken, caller: AdminOnly, service: ServiceDependency, response: Response
) -> CreatedToken | PendingToken:
    """Make a token; its secret is told this once. 202 if a second admin has to approve it."""
    groups = None if new.groups is None else frozenset(new.groups)
    spec = TokenSpec(
        name=new.name, scopes=new.scopes, robot=new.robot, days=new.days, groups=groups
    )
    spec.check()
    secret = new_secret(TOKEN_PREFIX)
    change = CreateToken(
        name=new.name,
        digest=secret_digest(secret),
        scopes=frozenset(new.scopes),
        robot=new.robot,
        days=new.days,
        groups=groups,
    )
    done = change_account(service, caller, change)
    if isinstance(done, PendingChangeView):
        response.status_code = HTTPStatus.ACCEPTED
        return PendingToken(waits=done, secret=secret)
    assert isinstance(done, TokenRow)  # noqa: S101 - of a change of tokens
    return CreatedToken(**_view(done), secret=secret)


@router.post("/renewal", status_code=201)
def renew(caller: TokenHolder, request: Request, service: ServiceDependency) -> CreatedToken:
    """Give the token that asks a new secret, for as long again; at its first use the old one ends.

    Until then the old secret holds to its own end, so an answer that was lost locks nobody out. 409
    if somebody else has got one within the last minute.
    """
    now, used = service.clock(), bearer_secret(request)
    event = caller.audit_event("renew token", caller.name.removeprefix("token:"))
    with audit_transaction(service, event) as session:
        token = find_token(session, now, used)
        if token is None:
            raise NotFoundError("the token has ended meanwhile")
        secret = renew_token(session, now, used)
        view = {**_view(token), "expires": now + lifetime_of(token)}
    return CreatedToken(**view, secret=secret)


@router.delete("/{token}", status_code=204)
def revoke(token: Name, caller: AdminOnly, request: Request, service: ServiceDependency) -> None:
    """Revoke a token; it stays in the list. The connection of its guard ends at once."""
    with audit_transaction(service, caller.audit_event("revoke token", token)) as session:
        revoke_token(session, service.clock(), token)
    request.app.state.collector.token_watch.recheck()


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
        "groups": token.groups,
    }
