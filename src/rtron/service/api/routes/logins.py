"""Logging in and out, and who one is."""

from anyio import to_thread
from fastapi import APIRouter, Request, Response

from rtron.service.api.auth.authentication import (
    begin_browser_session,
    client_address,
    delete_session_cookie,
    next_stage,
    set_session_cookie,
)
from rtron.service.api.auth.authorization import IdentifiedCaller, LoggedInUser, SessionHolder
from rtron.service.api.auth.login_attempts import (
    LoginThrottleDependency,
    PasswordProofDependency,
    check_login_throttle,
    login_attempt,
    login_origin,
)
from rtron.service.api.context import (
    ServiceContext,
    ServiceDependency,
    audit_transaction,
    record_refusal,
)
from rtron.service.api.schemas import CurrentUser, Login, PasswordChange
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import AuthenticationError
from rtron.service.domain.principal import SessionStage
from rtron.service.store.accounts.logins import end_session, renew_secret
from rtron.service.store.accounts.passwords import hash_password, verify_password
from rtron.service.store.accounts.users import find_user, get_user, set_password
from rtron.service.store.tables import UserRow

router = APIRouter()


@router.post("/login")
async def login(
    credentials: Login,
    request: Request,
    response: Response,
    service: ServiceDependency,
    throttle: LoginThrottleDependency,
) -> CurrentUser:
    """Log in with name and password; the session is in a cookie.

    If its stage is not complete, `POST /login/code` or the enrolment of a code completes it.
    """
    origin = await to_thread.run_sync(login_origin, service, request, credentials.name)
    where = origin.name, origin.address, origin.browser
    check_login_throttle(throttle, service, origin)
    with login_attempt(throttle, origin):
        async with request.app.state.login_queue.turn(throttle.rank(*where)):
            user = await to_thread.run_sync(
                _check_credentials, service, credentials, origin.address
            )
    me = await to_thread.run_sync(_begin_session, service, user, request, response)
    if me.stage is SessionStage.CODE:
        throttle.cancel_attempt(*where)
    else:
        throttle.record_success(*where)
    return me


@router.post("/logout", status_code=204)
def logout(caller: SessionHolder, response: Response, service: ServiceDependency) -> None:
    """End the session of this browser."""
    with audit_transaction(service, caller.audit_event("logout", caller.name)) as session:
        end_session(session, caller.session)
    delete_session_cookie(service, response)


@router.get("/me")
def me(caller: IdentifiedCaller) -> CurrentUser:
    """Tell who is logged in, and the CSRF token of the session ("" for a token)."""
    return CurrentUser(
        name=caller.name,
        roles=sorted(caller.roles),
        csrf=caller.csrf,
        stage=caller.stage,
        groups=None if caller.groups is None else sorted(caller.groups),
    )


@router.post("/me/password", status_code=204)
def change_password(
    change: PasswordChange,
    caller: LoggedInUser,
    response: Response,
    service: ServiceDependency,
    proof: PasswordProofDependency,
) -> None:
    """Change one's own password; one's other sessions end, and this one gets another cookie."""
    event = caller.audit_event("change password", caller.name)
    proof.check(caller, change.old, event, "the old password")
    hashed = hash_password(change.new)
    with audit_transaction(service, event) as session:
        set_password(session, get_user(session, caller.name), hashed, except_session=caller.session)
        set_session_cookie(service, response, renew_secret(session, caller.session))


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


def _begin_session(
    service: ServiceContext, user: UserRow, request: Request, response: Response
) -> CurrentUser:
    with service.database.session() as session:
        stage = next_stage(session, service.config, user)
    is_half = stage is SessionStage.CODE
    action = "login, password" if is_half else "login"
    event = AuditEvent(
        who=user.name, action=action, target=user.name, address=client_address(request)
    )
    with audit_transaction(service, event, is_repeatable=is_half) as session:
        current = get_user(session, user.name)
        if current.password_hash != user.password_hash or current.disabled:
            raise AuthenticationError("the name or the password is wrong")
        return begin_browser_session(session, service, request, response, current, stage)
