"""One-time codes as a second factor: shown at a login, enrolled and removed by their user."""

from typing import Annotated

import segno
from fastapi import APIRouter, Depends, Request, Response
from sqlalchemy.orm import Session

from rtron.service.api.auth.authentication import begin_browser_session
from rtron.service.api.auth.authorization import CodeAwaited, EnrollingUser, LoggedInUser, Principal
from rtron.service.api.auth.login_attempts import PasswordProofDependency, login_throttle
from rtron.service.api.context import ServiceContext, ServiceDependency, audit_transaction
from rtron.service.api.schemas import (
    CurrentUser,
    EnrolledFactor,
    Enrolment,
    OneTimeCode,
    OwnPassword,
    SecondFactorView,
)
from rtron.service.domain.client_address import network_prefix
from rtron.service.domain.code_throttle import CodeThrottle
from rtron.service.domain.errors import ForbiddenError, TooManyRequestsError
from rtron.service.domain.one_time_codes import otpauth_uri
from rtron.service.domain.principal import EnrolmentProof, SessionStage
from rtron.service.store.accounts.logins import began_within, end_sessions
from rtron.service.store.accounts.second_factors import (
    begin_enrolment,
    confirm_enrolment,
    count_recovery_codes,
    has_second_factor,
    is_one_time_code,
    remove_second_factor,
    use_code,
)
from rtron.service.store.accounts.users import get_user
from rtron.service.store.tables import UserRow
from rtron.vocabulary import SECOND

router = APIRouter()

FRESH_SIGN_IN = 600 * SECOND
"""A sign-in at the provider proves for so long who has a session."""


def code_throttle(request: Request) -> CodeThrottle:
    """Return what counts the codes that were tried."""
    throttle: CodeThrottle = request.app.state.code_throttle
    return throttle


class CodeAttempts:
    """Counts what a caller tries, where the user has logged in before or anywhere else."""

    def __init__(self, service: ServiceDependency, request: Request) -> None:
        self._service = service
        self._codes = code_throttle(request)
        self._logins = login_throttle(request)

    def begin(self, caller: Principal, code: str) -> None:
        """Count an attempt; TooManyRequestsError if it comes too soon."""
        if not is_one_time_code(code):
            return
        origin = self._known_origin(caller)
        delay = self._codes.begin_attempt(caller.name, origin, self._service.monotonic())
        if delay:
            seconds = -(-delay // SECOND)
            help = f"try again in {seconds} s, or use a recovery code"
            raise TooManyRequestsError("too many codes", retry_after=seconds, help=help)

    def succeed(self, caller: Principal) -> None:
        """Forget what failed: the code was right."""
        self._codes.record_success(caller.name, self._known_origin(caller))

    def log_in(self, caller: Principal) -> None:
        """Note that the user has logged in from there."""
        self.succeed(caller)
        self._logins.add_known(caller.name, caller.address)

    def _known_origin(self, caller: Principal) -> str:
        is_known = self._logins.is_known(caller.name, caller.address)
        return network_prefix(caller.address) if is_known else ""


CodeAttemptsDependency = Annotated[CodeAttempts, Depends(CodeAttempts)]


@router.post("/login/code")
def enter_code(
    given: OneTimeCode,
    caller: CodeAwaited,
    request: Request,
    response: Response,
    service: ServiceDependency,
    attempts: CodeAttemptsDependency,
) -> CurrentUser:
    """Show the code that a login waits for; the session has the user's roles from now on."""
    attempts.begin(caller, given.code)
    kind = "one-time code" if is_one_time_code(given.code) else "recovery code"
    with audit_transaction(service, caller.audit_event("login", caller.name, code=kind)) as session:
        user = get_user(session, caller.name)
        _check_code(session, service, caller, given.code)
        me = begin_browser_session(session, service, request, response, user, SessionStage.COMPLETE)
    attempts.log_in(caller)
    return me


@router.get("/me/second-factor")
def show(caller: EnrollingUser, service: ServiceDependency) -> SecondFactorView:
    """Tell whether one has a second factor."""
    with service.database.session() as session:
        user = get_user(session, caller.name)
        return SecondFactorView(
            is_enrolled=has_second_factor(session, user),
            recovery_codes=count_recovery_codes(session, user),
            proof=_needed_proof(session, service, caller, user),
        )


@router.post("/me/second-factor")
def enrol(
    given: OwnPassword,
    caller: EnrollingUser,
    service: ServiceDependency,
    password_proof: PasswordProofDependency,
) -> Enrolment:
    """Get a key for one-time codes, which counts once a code of it is shown.

    A session alone is not enough: it takes the password again, or, of who signs in at a provider,
    a sign-in of the last ten minutes.
    """
    event = caller.audit_event("begin second factor", caller.name)
    with service.database.session() as session:
        proof = _needed_proof(session, service, caller, get_user(session, caller.name))
    if proof is EnrolmentProof.PASSWORD:
        password_proof.check(caller, given.password, event, "the password")
    with audit_transaction(service, event) as session:
        if proof is EnrolmentProof.SIGN_IN:
            raise ForbiddenError("the sign-in is too old for that", help="sign in again first")
        key = begin_enrolment(session, service.clock(), get_user(session, caller.name))
    uri = otpauth_uri(key, caller.name)
    rows = ["".join(map(str, row)) for row in segno.make(uri, micro=False).matrix]
    return Enrolment(key=key, uri=uri, qr=rows)


@router.post("/me/second-factor/confirmation")
def confirm(
    given: OneTimeCode,
    caller: EnrollingUser,
    request: Request,
    response: Response,
    service: ServiceDependency,
    attempts: CodeAttemptsDependency,
) -> EnrolledFactor:
    """Show a first code: from now on a login takes one. One's other sessions end."""
    attempts.begin(caller, given.code)
    with audit_transaction(
        service, caller.audit_event("enrol second factor", caller.name)
    ) as session:
        user = get_user(session, caller.name)
        codes = confirm_enrolment(session, service.clock(), user, given.code)
        end_sessions(session, user.id)
        me = begin_browser_session(session, service, request, response, user, SessionStage.COMPLETE)
    attempts.log_in(caller)
    return EnrolledFactor(recovery_codes=list(codes), user=me)


@router.delete("/me/second-factor", status_code=204)
def remove(
    given: OneTimeCode,
    caller: LoggedInUser,
    service: ServiceDependency,
    attempts: CodeAttemptsDependency,
) -> None:
    """Remove one's second factor; it takes a code."""
    attempts.begin(caller, given.code)
    with audit_transaction(
        service, caller.audit_event("remove second factor", caller.name)
    ) as session:
        _check_code(session, service, caller, given.code)
        remove_second_factor(session, get_user(session, caller.name))
    attempts.succeed(caller)


def _needed_proof(
    session: Session, service: ServiceContext, caller: Principal, user: UserRow
) -> EnrolmentProof:
    if user.subject is None:
        return EnrolmentProof.PASSWORD
    is_fresh = began_within(session, service.clock(), caller.session, FRESH_SIGN_IN)
    return EnrolmentProof.NONE if is_fresh else EnrolmentProof.SIGN_IN


def _check_code(session: Session, service: ServiceContext, caller: Principal, code: str) -> None:
    if not use_code(session, service.clock(), get_user(session, caller.name), code):
        raise ForbiddenError("the code is wrong, or was used before", help="wait for the next one")
