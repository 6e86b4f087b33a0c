"""Who a request is from: a browser by its cookie, a program by its token."""

import hmac

from fastapi import Request, Response
from sqlalchemy.orm import Session
from starlette.requests import HTTPConnection

from rtron.service.api.context import ServiceContext
from rtron.service.api.schemas import CurrentUser
from rtron.service.config import ServiceConfig
from rtron.service.domain.errors import AuthenticationError, ForbiddenError
from rtron.service.domain.principal import (
    TOKEN_ROLES,
    AccessScope,
    Principal,
    SessionStage,
    UserRole,
    group_set,
)
from rtron.service.store.accounts.last_use import record_use
from rtron.service.store.accounts.logins import (
    MAX_AGE_S,
    SessionLifetime,
    begin_session,
    end_session,
    find_known_browser,
    find_session,
    is_anybodys_browser,
    remember_browser,
)
from rtron.service.store.accounts.random_secrets import secret_digest
from rtron.service.store.accounts.second_factors import has_second_factor
from rtron.service.store.accounts.tokens import find_token, promote_secret, record_replaced_secret
from rtron.service.store.accounts.users import roles_of
from rtron.service.store.tables import SessionRow, TokenRow, UserRow

CSRF_HEADER = "X-CSRF-Token"
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_BEARER = "bearer "
_MAX_SECRET_LENGTH = 200


def authenticate(service: ServiceContext, connection: HTTPConnection) -> Principal:
    """Return who a request, or a WebSocket, is from; AuthenticationError if that is nobody.

    Where there is a token, the cookie does not count. That it is used is noted.
    """
    caller, row = _identify(service, connection)
    record_use(service.database, row, service.clock())
    return caller


def identify(service: ServiceContext, connection: HTTPConnection) -> Principal:
    """Return who a request is from, as `authenticate` does, without noting a use: nobody acts."""
    return _identify(service, connection)[0]


def check_csrf(caller: Principal, request: Request) -> None:
    """Raise ForbiddenError for a change from a browser without the session's CSRF token."""
    if request.method in SAFE_METHODS or not caller.session:
        return
    token = request.headers.get(CSRF_HEADER, "")
    if not hmac.compare_digest(token.encode(), caller.csrf.encode()):
        help = f"GET /api/v1/me gives it; send it in the header {CSRF_HEADER}"
        raise ForbiddenError("the CSRF token is missing or wrong", help=help)


def cookie_name(config: ServiceConfig) -> str:
    """Return the name of the session's cookie; `__Host-` binds it to HTTPS and to this host."""
    return "__Host-rtron" if config.is_secure else "rtron"


def session_lifetime(config: ServiceConfig) -> SessionLifetime:
    """Return how long sessions last."""
    return SessionLifetime(idle=config.session_idle_timeout, maximum=config.session_lifetime)


def bearer_secret(connection: HTTPConnection) -> str:
    """Return the secret of the token that a request shows."""
    return connection.headers.get("authorization", "")[len(_BEARER) :].strip()


def client_address(connection: HTTPConnection) -> str:
    """Return the address that a request is from, "" for a local socket."""
    return connection.client.host[:60] if connection.client else ""


def _identify(
    service: ServiceContext, connection: HTTPConnection
) -> tuple[Principal, TokenRow] | tuple[Principal, SessionRow]:
    authorization = connection.headers.get("authorization")
    if authorization is not None:
        return _token_principal(service, connection, authorization)
    return _session_principal(service, connection)


def _token_principal(
    service: ServiceContext, connection: HTTPConnection, authorization: str
) -> tuple[Principal, TokenRow]:
    secret = bearer_secret(connection)
    if authorization[: len(_BEARER)].lower() != _BEARER or len(secret) > _MAX_SECRET_LENGTH:
        raise AuthenticationError(
            "Authorization has no bearer token", help="Authorization: Bearer rtron_…"
        )
    now, address = service.clock(), client_address(connection)
    with service.database.session() as session:
        token = find_token(session, now, secret)
    if token is None:
        record_replaced_secret(service.database, now, secret, address)
        raise AuthenticationError(
            "the token is unknown, over or revoked", help="ask an admin for one"
        )
    promote_secret(service.database, token, now, secret)
    scopes = frozenset(map(AccessScope, token.scopes))
    roles = frozenset(TOKEN_ROLES[scope] for scope in scopes if scope in TOKEN_ROLES)
    caller = Principal(
        name=f"token:{token.name}",
        roles=roles,
        scopes=scopes,
        address=address,
        groups=group_set(token.groups, roles),
    )
    return caller, token


def _session_principal(
    service: ServiceContext, connection: HTTPConnection
) -> tuple[Principal, SessionRow]:
    secret = connection.cookies.get(cookie_name(service.config), "")
    hashed, now = secret_digest(secret[:_MAX_SECRET_LENGTH]), service.clock()
    with service.database.session() as session:
        match = find_session(session, now, hashed, session_lifetime(service.config))
    if match is None:
        raise AuthenticationError("not logged in", help="log in, or send a token")
    login, user = match
    caller = Principal(
        name=user.name,
        roles=roles_of(user) if login.stage == SessionStage.COMPLETE else frozenset(),
        address=client_address(connection),
        session=hashed,
        csrf=login.csrf,
        stage=SessionStage(login.stage),
        groups=group_set(user.groups, roles_of(user)),
    )
    return caller, login


def next_stage(session: Session, config: ServiceConfig, user: UserRow) -> SessionStage:
    """Return what a user has to do after the password: show a code, enrol one, or nothing."""
    if has_second_factor(session, user):
        return SessionStage.CODE
    is_required = config.second_factor_roles & set(map(UserRole, user.roles))
    return SessionStage.ENROLMENT if is_required else SessionStage.COMPLETE


def begin_browser_session(
    session: Session,
    service: ServiceContext,
    request: Request,
    response: Response,
    user: UserRow,
    stage: SessionStage,
) -> CurrentUser:
    """Begin a session with a new secret, whatever the browser sent; that one ends."""
    end_session(session, secret_digest(request.cookies.get(cookie_name(service.config), "")))
    lifetime = session_lifetime(service.config)
    login = begin_session(session, service.clock(), user, lifetime, stage)
    set_session_cookie(service, response, login.secret)
    if stage is SessionStage.COMPLETE:
        _remember_browser(session, service, request, response, user)
    roles = sorted(map(UserRole, user.roles)) if stage is SessionStage.COMPLETE else []
    return CurrentUser(
        name=user.name, roles=roles, csrf=login.csrf, stage=stage, groups=user.groups
    )


def set_session_cookie(service: ServiceContext, response: Response, secret: str) -> None:
    """Let the browser show this secret from now on."""
    response.set_cookie(
        cookie_name(service.config),
        secret,
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )


def browser_cookie_name(config: ServiceConfig) -> str:
    """Return the name of the cookie of a browser in which a user has logged in."""
    return "__Host-rtron-browser" if config.is_secure else "rtron-browser"


def is_known_browser(service: ServiceContext, request: Request) -> bool:
    """Tell whether somebody has logged in in this browser before."""
    secret = request.cookies.get(browser_cookie_name(service.config), "")[:200]
    with service.database.session() as session:
        return bool(secret) and is_anybodys_browser(session, service.clock(), secret)


def _remember_browser(
    session: Session, service: ServiceContext, request: Request, response: Response, user: UserRow
) -> None:
    """Let the browser be known as this user's, if it is not yet."""
    name, now = browser_cookie_name(service.config), service.clock()
    if find_known_browser(session, now, user.name, request.cookies.get(name, "")[:200]):
        return
    response.set_cookie(
        name,
        remember_browser(session, now, user),
        max_age=MAX_AGE_S,
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )


def delete_session_cookie(service: ServiceContext, response: Response) -> None:
    """Let the browser forget its session."""
    response.delete_cookie(
        cookie_name(service.config),
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )
