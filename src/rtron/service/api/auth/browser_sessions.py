"""Sessions of browsers: however somebody logs in, a new secret in a cookie that no script reads."""

from fastapi import Request, Response
from sqlalchemy.orm import Session

from rtron.service.api.auth.authentication import cookie_name, session_lifetime
from rtron.service.api.context import ServiceContext
from rtron.service.api.schemas import CurrentUser
from rtron.service.config import ServiceConfig
from rtron.service.domain.roles import SessionStage, UserRole
from rtron.service.store.accounts.logins import (
    MAX_AGE_S,
    begin_session,
    end_session,
    find_known_browser,
    is_anybodys_browser,
    remember_browser,
)
from rtron.service.store.accounts.passwords import secret_digest
from rtron.service.store.accounts.second_factors import has_second_factor
from rtron.service.store.tables import UserRow


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
