"""Who a request is from: a browser by its cookie, a program by its token."""

import hmac
from dataclasses import dataclass

from fastapi import Request
from starlette.requests import HTTPConnection

from rtron.service.api.context import Service
from rtron.service.config import Config
from rtron.service.domain.errors import ForbiddenError, LoginError
from rtron.service.domain.schemas import Scope, UserRole
from rtron.service.store.accounts.last_use import note_use
from rtron.service.store.accounts.logins import Lifetime, find_login
from rtron.service.store.accounts.secrets import digest
from rtron.service.store.accounts.tokens import find_token
from rtron.service.store.accounts.users import roles_of
from rtron.service.store.audit import Deed
from rtron.service.store.tables import SessionRow, TokenRow

CSRF_HEADER = "X-CSRF-Token"
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_BEARER = "bearer "
_LONGEST = 200
_ROLES = {
    Scope.END_USER: UserRole.END_USER,
    Scope.DEVELOPER: UserRole.DEVELOPER,
    Scope.ADMIN: UserRole.ADMIN,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Caller:
    """Who asks. A token is called `token:NAME`; its scopes are those of roles, too.

    `session` is the digest of a browser's session, `csrf` its token; both "" for a token.
    """

    name: str
    roles: frozenset[UserRole]
    scopes: frozenset[Scope] = frozenset()
    address: str = ""
    session: str = ""
    csrf: str = ""

    @property
    def may_read(self) -> bool:
        """Whether robots, events and settings may be seen."""
        return bool(self.roles) or Scope.READ in self.scopes

    def deed(self, action: str, target: str, **detail: object) -> Deed:
        """Return what the audit log says of what the caller does."""
        return Deed(
            who=self.name, action=action, target=target, address=self.address, detail=detail
        )


def caller_of(service: Service, connection: HTTPConnection) -> Caller:
    """Return who a request, or a WebSocket, is from; LoginError if that is nobody.

    Where there is a token, the cookie does not count. That it is used is noted.
    """
    caller, row = _found(service, connection)
    note_use(service.database, row, service.clock())
    return caller


def watcher_of(service: Service, connection: HTTPConnection) -> Caller:
    """Return who a request is from, as `caller_of` does, without noting a use: nobody acts."""
    return _found(service, connection)[0]


def check_csrf(caller: Caller, request: Request) -> None:
    """Raise ForbiddenError for a change from a browser without the session's CSRF token."""
    if request.method in SAFE_METHODS or not caller.session:
        return
    given = request.headers.get(CSRF_HEADER, "")
    if not hmac.compare_digest(given.encode(), caller.csrf.encode()):
        help = f"GET /api/v1/me gives it; send it in the header {CSRF_HEADER}"
        raise ForbiddenError("the CSRF token is missing or wrong", help=help)


def cookie_name(config: Config) -> str:
    """Return the name of the session's cookie; `__Host-` binds it to HTTPS and to this host."""
    return "__Host-rtron" if config.is_secure else "rtron"


def lifetime(config: Config) -> Lifetime:
    """Return how long sessions last."""
    return Lifetime(idle=config.session_idle, longest=config.session_longest)


def address_of(connection: HTTPConnection) -> str:
    """Return the address that a request is from, "" for a local socket."""
    return connection.client.host[:60] if connection.client else ""


def _found(
    service: Service, connection: HTTPConnection
) -> tuple[Caller, TokenRow] | tuple[Caller, SessionRow]:
    authorization = connection.headers.get("authorization")
    if authorization is not None:
        return _program(service, connection, authorization)
    return _browser(service, connection)


def _program(
    service: Service, connection: HTTPConnection, authorization: str
) -> tuple[Caller, TokenRow]:
    secret = authorization[len(_BEARER) :].strip()
    if authorization[: len(_BEARER)].lower() != _BEARER or len(secret) > _LONGEST:
        raise LoginError("Authorization has no bearer token", help="Authorization: Bearer rtron_…")
    with service.database.session() as session:
        token = find_token(session, service.clock(), secret)
    if token is None:
        raise LoginError("the token is unknown, over or revoked", help="ask an admin for one")
    scopes = frozenset(map(Scope, token.scopes))
    caller = Caller(
        name=f"token:{token.name}",
        roles=frozenset(_ROLES[scope] for scope in scopes if scope in _ROLES),
        scopes=scopes,
        address=address_of(connection),
    )
    return caller, token


def _browser(service: Service, connection: HTTPConnection) -> tuple[Caller, SessionRow]:
    secret = connection.cookies.get(cookie_name(service.config), "")
    hashed, now = digest(secret[:_LONGEST]), service.clock()
    with service.database.session() as session:
        found = find_login(session, now, hashed, lifetime(service.config))
    if found is None:
        raise LoginError("not logged in", help="log in, or send a token")
    login, user = found
    caller = Caller(
        name=user.name,
        roles=roles_of(user),
        address=address_of(connection),
        session=hashed,
        csrf=login.csrf,
    )
    return caller, login
