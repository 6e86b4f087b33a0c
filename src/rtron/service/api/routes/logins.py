"""Logging in and out, and who one is."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from rtron.service.api.audit_transaction import audit_transaction, record_refusal
from rtron.service.api.auth.authentication import client_address, cookie_name, session_lifetime
from rtron.service.api.auth.authorization import IdentifiedCaller, LoggedInUser, Principal
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.api.schemas import CurrentUser, Login, PasswordChange
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import AuthenticationError, ForbiddenError, TooManyRequestsError
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.domain.roles import UserRole
from rtron.service.store.accounts.logins import NewSession, begin_session, end_session
from rtron.service.store.accounts.passwords import hash_password, verify_password
from rtron.service.store.accounts.secrets import secret_digest
from rtron.service.store.accounts.users import find_user, get_user, set_password
from rtron.service.store.tables import UserRow
from rtron.vocabulary import SECOND

router = APIRouter()


def _login_throttle(request: Request) -> LoginThrottle:
    throttle: LoginThrottle = request.app.state.login_throttle
    return throttle


LoginThrottleDependency = Annotated[LoginThrottle, Depends(_login_throttle)]


@router.post("/login")
def login(
    credentials: Login,
    request: Request,
    response: Response,
    service: ServiceDependency,
    throttle: LoginThrottleDependency,
) -> CurrentUser:
    """Log in with name and password; the session is in a cookie."""
    address = client_address(request)
    _check_throttle(throttle, service, credentials.name, address)
    with _attempt(throttle, credentials.name, address):
        user = _check_credentials(service, credentials, address)
    throttle.record_success(credentials.name, address)
    session = _begin_session(service, user, request)
    response.set_cookie(
        cookie_name(service.config),
        session.secret,
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )
    return CurrentUser(name=user.name, roles=sorted(map(UserRole, user.roles)), csrf=session.csrf)


@router.post("/logout", status_code=204)
def logout(caller: LoggedInUser, response: Response, service: ServiceDependency) -> None:
    """End the session of this browser."""
    with audit_transaction(service, caller.audit_event("logout", caller.name)) as session:
        end_session(session, caller.session)
    response.delete_cookie(
        cookie_name(service.config),
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )


@router.get("/me")
def me(caller: IdentifiedCaller) -> CurrentUser:
    """Tell who is logged in, and the CSRF token of the session ("" for a token)."""
    return CurrentUser(name=caller.name, roles=sorted(caller.roles), csrf=caller.csrf)


@router.post("/me/password", status_code=204)
def change_password(
    change: PasswordChange,
    caller: LoggedInUser,
    service: ServiceDependency,
    throttle: LoginThrottleDependency,
) -> None:
    """Change one's own password; one's other sessions end."""
    _check_throttle(throttle, service, caller.name, caller.address)
    event = caller.audit_event("change password", caller.name)
    with _attempt(throttle, caller.name, caller.address):
        is_right = verify_password(change.old, _password_hash(service, caller))
    if not is_right:
        record_refusal(service, event, "the old password is wrong")
        raise ForbiddenError("the old password is wrong")
    throttle.record_success(caller.name, caller.address)
    hashed = hash_password(change.new)
    with audit_transaction(service, event) as session:
        set_password(session, get_user(session, caller.name), hashed, except_session=caller.session)


def _check_throttle(
    throttle: LoginThrottle, service: ServiceContext, name: str, address: str
) -> None:
    delay = throttle.begin_attempt(name, address, service.clock())
    if delay:
        seconds = -(-delay // SECOND)
        raise TooManyRequestsError(
            "too many attempts", retry_after=seconds, help=f"try again in {seconds} s"
        )


@contextmanager
def _attempt(throttle: LoginThrottle, name: str, address: str) -> Iterator[None]:
    """Take an attempt back that was not judged, since too many came at the same moment."""
    try:
        yield
    except TooManyRequestsError:
        throttle.cancel_attempt(name, address)
        raise


def _check_credentials(service: ServiceContext, credentials: Login, address: str) -> UserRow:
    """Return the user; AuthenticationError takes as long for a name that nobody has."""
    with service.database.session() as session:
        user = find_user(session, credentials.name)
    is_right = verify_password(credentials.password, user.password_hash if user else None)
    if user and is_right and not user.disabled:
        return user
    # A name that nobody has may be a password in the wrong field.
    target = user.name if user else "an unknown name"
    event = AuditEvent(
        who=user.name if user else "", action="login", target=target, address=address
    )
    record_refusal(service, event, "disabled" if is_right else "wrong password")
    raise AuthenticationError("the name or the password is wrong")


def _begin_session(service: ServiceContext, user: UserRow, request: Request) -> NewSession:
    """Begin a session with a new secret, whatever the browser sent; that one ends."""
    event = AuditEvent(
        who=user.name, action="login", target=user.name, address=client_address(request)
    )
    with audit_transaction(service, event) as session:
        end_session(session, secret_digest(request.cookies.get(cookie_name(service.config), "")))
        current = get_user(session, user.name)
        if current.password_hash != user.password_hash or current.disabled:
            raise AuthenticationError("the name or the password is wrong")
        return begin_session(session, service.clock(), current, session_lifetime(service.config))


def _password_hash(service: ServiceContext, caller: Principal) -> str:
    with service.database.session() as session:
        return get_user(session, caller.name).password_hash
