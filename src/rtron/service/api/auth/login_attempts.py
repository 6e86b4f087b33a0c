"""Attempts to log in, counted before they are judged."""

import asyncio
from bisect import insort
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from itertools import count
from typing import Annotated

from fastapi import Depends, Request

from rtron.errors import InputError
from rtron.service.api.auth.authentication import browser_cookie_name, client_address
from rtron.service.api.context import ServiceContext, ServiceDependency, record_refusal
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import ForbiddenError, TooManyRequestsError
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.domain.principal import Principal
from rtron.service.store.accounts.logins import find_known_browser
from rtron.service.store.accounts.passwords import verify_password
from rtron.service.store.accounts.users import get_user
from rtron.vocabulary import SECOND

_MAX_SECRET_LENGTH = 200


def login_throttle(request: Request) -> LoginThrottle:
    """Return what counts the failed logins."""
    throttle: LoginThrottle = request.app.state.login_throttle
    return throttle


LoginThrottleDependency = Annotated[LoginThrottle, Depends(login_throttle)]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoginOrigin:
    """Who tries to log in from where; `browser` is one in which that user has logged in, or ""."""

    name: str
    address: str
    browser: str = ""


def login_origin(service: ServiceContext, request: Request, name: str) -> LoginOrigin:
    """Return where an attempt for a name comes from; a known browser has a cookie."""
    secret = request.cookies.get(browser_cookie_name(service.config), "")[:_MAX_SECRET_LENGTH]
    browser = ""
    if secret:
        with service.database.session() as session:
            browser = find_known_browser(session, service.clock(), name, secret)
    return LoginOrigin(name=name, address=client_address(request), browser=browser)


def check_login_throttle(
    throttle: LoginThrottle, service: ServiceContext, origin: LoginOrigin
) -> None:
    """Count an attempt as failed; TooManyRequestsError if it comes too soon."""
    delay = throttle.begin_attempt(origin.name, origin.address, service.monotonic(), origin.browser)
    if delay:
        seconds = -(-delay // SECOND)
        raise TooManyRequestsError(
            "too many attempts", retry_after=seconds, help=f"try again in {seconds} s"
        )


@contextmanager
def login_attempt(throttle: LoginThrottle, origin: LoginOrigin) -> Iterator[None]:
    """Take an attempt back that was not judged, since too many came at the same moment."""
    try:
        yield
    except TooManyRequestsError:
        throttle.cancel_attempt(origin.name, origin.address, origin.browser)
        raise


class PasswordProof:
    """Asks who has a session for the password again: whoever has stolen the session lacks it."""

    def __init__(
        self, service: ServiceDependency, request: Request, throttle: LoginThrottleDependency
    ) -> None:
        self._service, self._request, self._throttle = service, request, throttle

    def check(self, caller: Principal, password: str, event: AuditEvent, name: str) -> None:
        """Raise ForbiddenError, which is in the audit log, if the password called `name` is wrong.

        InputError if there is none. It counts like an attempt to log in.
        """
        if not password:
            raise InputError(f"{name} is missing")
        origin = login_origin(self._service, self._request, caller.name)
        check_login_throttle(self._throttle, self._service, origin)
        with self._service.database.session() as session:
            hashed = get_user(session, caller.name).password_hash
        with login_attempt(self._throttle, origin):
            is_right = verify_password(password, hashed)
        if not is_right:
            record_refusal(self._service, event, f"{name} is wrong")
            raise ForbiddenError(f"{name} is wrong")
        self._throttle.record_success(origin.name, origin.address, origin.browser)


PasswordProofDependency = Annotated[PasswordProof, Depends(PasswordProof)]


CONCURRENT_LOGINS = 2
"""Each check takes 64 MiB and a core."""
MAX_WAITING = 64
"""With one more the last in the queue is turned away."""


@dataclass(order=True, slots=True)
class _Waiting:
    rank: int
    number: int
    turn: "asyncio.Future[None]" = field(compare=False)


class LoginQueue:
    """Lets few in at a time, those of the lowest rank first; used in the event loop."""

    def __init__(self) -> None:
        self._free = CONCURRENT_LOGINS
        self._waiting: list[_Waiting] = []
        self._numbers = count()

    @asynccontextmanager
    async def turn(self, rank: int) -> AsyncIterator[None]:
        """Wait for a turn, which ends with the block; TooManyRequestsError if too many wait."""
        await self._enter(rank)
        try:
            yield
        finally:
            self._leave()

    async def _enter(self, rank: int) -> None:
        if self._free:
            self._free -= 1
            return
        turn = asyncio.get_running_loop().create_future()
        waiting = _Waiting(rank, next(self._numbers), turn)
        insort(self._waiting, waiting)
        if len(self._waiting) > MAX_WAITING:
            error = TooManyRequestsError("too many logins at this moment", help="try again soon")
            self._waiting.pop().turn.set_exception(error)
        try:
            await turn
        except asyncio.CancelledError:
            if waiting in self._waiting:
                self._waiting.remove(waiting)
            elif not turn.cancelled() and turn.exception() is None:
                self._leave()
            raise

    def _leave(self) -> None:
        while self._waiting:
            turn = self._waiting.pop(0).turn
            if not turn.done():
                turn.set_result(None)
                return
        self._free += 1
