"""Logging in and out, and who one is."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from rtron.service.api.audit_transaction import audited, note_refused
from rtron.service.api.auth.authentication import address_of, cookie_name, lifetime
from rtron.service.api.auth.authorization import Caller, Person, Watcher
from rtron.service.api.context import Served, Service
from rtron.service.domain.errors import ForbiddenError, LoginError, TooManyError
from rtron.service.domain.login_throttle import SECOND, Attempts
from rtron.service.domain.schemas import Login, Me, PasswordChange, UserRole
from rtron.service.store.accounts.logins import NewLogin, begin_login, end_login
from rtron.service.store.accounts.passwords import hash_password, matches
from rtron.service.store.accounts.secrets import digest
from rtron.service.store.accounts.users import find_user, set_password, the_user
from rtron.service.store.audit import Deed
from rtron.service.store.tables import UserRow

router = APIRouter()


def _attempts_of(request: Request) -> Attempts:
    attempts: Attempts = request.app.state.attempts
    return attempts


Tried = Annotated[Attempts, Depends(_attempts_of)]


@router.post("/login")
def login(
    given: Login, request: Request, response: Response, service: Served, attempts: Tried
) -> Me:
    """Log in with name and password; the session is in a cookie."""
    address = address_of(request)
    _wait_for_turn(attempts, service, given.name, address)
    with _judging(attempts, given.name, address):
        user = _judged(service, given, address)
    attempts.succeeded(given.name, address)
    made = _begun(service, user, request)
    response.set_cookie(
        cookie_name(service.config),
        made.secret,
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )
    return Me(name=user.name, roles=sorted(map(UserRole, user.roles)), csrf=made.csrf)


@router.post("/logout", status_code=204)
def logout(caller: Person, response: Response, service: Served) -> None:
    """End the session of this browser."""
    with audited(service, caller.deed("logout", caller.name)) as session:
        end_login(session, caller.session)
    response.delete_cookie(
        cookie_name(service.config),
        httponly=True,
        secure=service.config.is_secure,
        samesite="strict",
    )


@router.get("/me")
def me(caller: Watcher) -> Me:
    """Tell who is logged in, and the CSRF token of the session ("" for a token)."""
    return Me(name=caller.name, roles=sorted(caller.roles), csrf=caller.csrf)


@router.post("/me/password", status_code=204)
def change_password(
    given: PasswordChange, caller: Person, service: Served, attempts: Tried
) -> None:
    """Change one's own password; one's other sessions end."""
    _wait_for_turn(attempts, service, caller.name, caller.address)
    deed = caller.deed("change password", caller.name)
    with _judging(attempts, caller.name, caller.address):
        is_right = matches(given.old, _hash_of(service, caller))
    if not is_right:
        note_refused(service, deed, "the old password is wrong")
        raise ForbiddenError("the old password is wrong")
    attempts.succeeded(caller.name, caller.address)
    hashed = hash_password(given.new)
    with audited(service, deed) as session:
        set_password(session, the_user(session, caller.name), hashed, keep=caller.session)


def _wait_for_turn(attempts: Attempts, service: Service, name: str, address: str) -> None:
    wait = attempts.begin(name, address, service.clock())
    if wait:
        seconds = -(-wait // SECOND)
        raise TooManyError("too many attempts", wait=seconds, help=f"try again in {seconds} s")


@contextmanager
def _judging(attempts: Attempts, name: str, address: str) -> Iterator[None]:
    """Take an attempt back that was not judged, since too many came at the same moment."""
    try:
        yield
    except TooManyError:
        attempts.take_back(name, address)
        raise


def _judged(service: Service, given: Login, address: str) -> UserRow:
    """Return the user; LoginError takes as long for a name that nobody has."""
    with service.database.session() as session:
        user = find_user(session, given.name)
    is_right = matches(given.password, user.password_hash if user else None)
    if user and is_right and not user.disabled:
        return user
    # A name that nobody has may be a password in the wrong field.
    target = user.name if user else "an unknown name"
    deed = Deed(who=user.name if user else "", action="login", target=target, address=address)
    note_refused(service, deed, "disabled" if is_right else "wrong password")
    raise LoginError("the name or the password is wrong")


def _begun(service: Service, user: UserRow, request: Request) -> NewLogin:
    """Begin a session with a new secret, whatever the browser sent; that one ends."""
    deed = Deed(who=user.name, action="login", target=user.name, address=address_of(request))
    with audited(service, deed) as session:
        end_login(session, digest(request.cookies.get(cookie_name(service.config), "")))
        current = the_user(session, user.name)
        if current.password_hash != user.password_hash or current.disabled:
            raise LoginError("the name or the password is wrong")
        return begin_login(session, service.clock(), current, lifetime(service.config))


def _hash_of(service: Service, caller: Caller) -> str:
    with service.database.session() as session:
        return the_user(session, caller.name).password_hash
