"""Sign-in at an OpenID provider: the way there, and the way back with a session or a reason."""

import logging
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from threading import BoundedSemaphore
from typing import TYPE_CHECKING, Annotated, Any

from fastapi import APIRouter, Depends, Request
from pydantic import TypeAdapter, ValidationError
from starlette.responses import RedirectResponse

from rtron.errors import RTronError
from rtron.service.api.auth.authentication import (
    begin_browser_session,
    client_address,
    is_known_browser,
    next_stage,
)
from rtron.service.api.context import ServiceContext, ServiceDependency, record_refusal
from rtron.service.api.schemas import LoginMethods
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.oidc import (
    OidcConfig,
    PendingSignIn,
    ProviderUser,
    SignInError,
    SignInProblem,
)
from rtron.service.domain.principal import SessionStage
from rtron.service.domain.schemas import Name
from rtron.service.store.accounts.last_use import WarningThrottle
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.random_secrets import new_password
from rtron.service.store.accounts.users import sign_in, withdraw_roles
from rtron.service.store.audit import record_event
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from rtron.service.api.auth.oidc_client import OidcClient

log = logging.getLogger(__name__)

router = APIRouter()

MAX_AT_A_TIME = 8
MAX_STRANGERS = 4
"""Browsers in which nobody has logged in: anybody can keep these places busy, and no others."""
_PENDING_S = 600
_SEE_OTHER = 303
_name = TypeAdapter(Name)
_warnings = WarningThrottle()


class OidcSignIn:
    """The provider's client, which a few requests use at a time."""

    def __init__(self, config: OidcConfig, client: "OidcClient") -> None:
        self.config = config
        self.client = client
        self._places = BoundedSemaphore(MAX_AT_A_TIME)
        self._stranger_places = BoundedSemaphore(MAX_STRANGERS)

    @contextmanager
    def place(self, service: ServiceContext, request: Request) -> Iterator[None]:
        """Take a place to talk with the provider; SignInError if all are taken."""
        is_known = is_known_browser(service, request)
        with ExitStack() as stack:
            for each in [self._places] if is_known else [self._stranger_places, self._places]:
                if not each.acquire(blocking=False):
                    raise SignInError(SignInProblem.BUSY)
                stack.callback(each.release)
            yield


def _oidc(request: Request) -> OidcSignIn:
    found: OidcSignIn | None = request.app.state.oidc
    if found is None:
        raise NotFoundError("this service has no single sign-on", help="log in with a password")
    return found


OidcDependency = Annotated[OidcSignIn, Depends(_oidc)]


@router.get("/login/methods")
async def login_methods(request: Request) -> LoginMethods:
    """Tell how one may log in, before one has."""
    oidc: OidcSignIn | None = request.app.state.oidc
    return LoginMethods(oidc=oidc.config.display_name if oidc else None)


@router.get("/login/oidc", status_code=_SEE_OTHER, response_class=RedirectResponse)
def begin(request: Request, service: ServiceDependency, oidc: OidcDependency) -> RedirectResponse:
    """Send the browser to the provider."""
    pending = PendingSignIn.begin()
    try:
        with oidc.place(service, request):
            answer = RedirectResponse(oidc.client.authorization_url(pending), _SEE_OTHER)
    except SignInError as error:
        return _back(error)
    answer.set_cookie(
        _cookie(service),
        str(pending),
        max_age=_PENDING_S,
        httponly=True,
        secure=service.config.is_secure,
        samesite="lax",  # the provider's page leads back here
    )
    return answer


@router.get("/login/oidc/callback", status_code=_SEE_OTHER, response_class=RedirectResponse)
def finish(request: Request, service: ServiceDependency, oidc: OidcDependency) -> RedirectResponse:
    """Begin a session for who comes back from the provider with a role."""
    answer = RedirectResponse("/", _SEE_OTHER)
    try:
        signed_in = _signed_in(request, service, oidc)
        _begin_session(request, answer, service, oidc, signed_in)
    except SignInError as error:
        answer = _back(error)
    answer.delete_cookie(_cookie(service), httponly=True, secure=service.config.is_secure)
    return answer


def _signed_in(request: Request, service: ServiceContext, oidc: OidcSignIn) -> ProviderUser:
    pending = PendingSignIn.parse(request.cookies.get(_cookie(service), ""))
    with oidc.place(service, request):
        return oidc.client.finish(request.query_params, pending, service.clock() / SECOND)


def _begin_session(
    request: Request,
    answer: RedirectResponse,
    service: ServiceContext,
    oidc: OidcSignIn,
    signed_in: ProviderUser,
) -> None:
    event = _event(request, signed_in)
    try:
        _check_user(service, signed_in)
        unusable = hash_password(new_password())
        with service.database.session() as session:
            user = sign_in(session, service.clock(), signed_in, unusable)
            stage = next_stage(session, service.config, user)
            if oidc.config.provider_checks_second_factor:
                stage = SessionStage.COMPLETE
            begin_browser_session(session, service, request, answer, user, stage)
            record_event(session, service.clock(), _with_stage(event, stage))
    except (RTronError, SignInError) as error:
        record_refusal(service, event, str(error))
        raise


def _check_user(service: ServiceContext, signed_in: ProviderUser) -> None:
    """Raise SignInError for who has no role, or a name that no user can have."""
    if not signed_in.roles:
        with service.database.session() as session:
            withdraw_roles(session, signed_in.subject)
        raise SignInError(SignInProblem.NO_ROLE)
    try:
        _name.validate_python(signed_in.name)
    except ValidationError:
        raise SignInError(SignInProblem.BAD_NAME) from None


def _event(request: Request, signed_in: ProviderUser) -> AuditEvent:
    detail: dict[str, Any] = {"oidc": signed_in.subject, "roles": sorted(signed_in.roles)}
    name = signed_in.name[:100]
    return AuditEvent(
        who=name, action="login", target=name, address=client_address(request), detail=detail
    )


def _with_stage(event: AuditEvent, stage: SessionStage) -> AuditEvent:
    """Return the event of what is half a login only as long as the code is not shown."""
    return replace(event, action="login, provider") if stage is SessionStage.CODE else event


def _back(error: SignInError) -> RedirectResponse:
    """Lead to the login page, which says why in its own words.

    The log has what an operator can mend, once a minute: strangers come here, too.
    """
    if error.problem is SignInProblem.FAILED and _warnings.is_due():
        log.warning("the sign-in at the provider fails: %s", error)
    return RedirectResponse(f"/?sign_in={error.problem.value}", _SEE_OTHER)


def _cookie(service: ServiceContext) -> str:
    return "__Host-rtron-sign-in" if service.config.is_secure else "rtron-sign-in"
