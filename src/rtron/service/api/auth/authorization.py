"""Who may call what: dependencies of the endpoints. Refused changes are in the audit log."""

from collections.abc import Callable
from typing import Annotated

from fastapi import Depends, Request

from rtron.service.api.audit_transaction import record_refusal
from rtron.service.api.auth.authentication import SAFE_METHODS, authenticate, check_csrf, identify
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import Principal
from rtron.service.domain.roles import AccessScope, UserRole

__all__ = [
    "AdminOnly",
    "Auditor",
    "DeveloperOnly",
    "IdentifiedCaller",
    "LoggedInUser",
    "MetricsReader",
    "Principal",
    "Reader",
    "RoleHolder",
]

Permission = Callable[[Principal], bool]


def require(
    permission: Permission, requirement: str
) -> Callable[[ServiceContext, Request], Principal]:
    """Make the dependency that gives the caller if `permission`, else raises ForbiddenError."""

    def check(service: ServiceDependency, request: Request) -> Principal:
        caller = authenticate(service, request)
        try:
            check_csrf(caller, request)
            _check_permission(caller, permission, requirement)
        except ForbiddenError as error:
            _record_refusal(service, request, caller, error)
            raise
        return caller

    return check


def _check_permission(caller: Principal, permission: Permission, requirement: str) -> None:
    if not permission(caller):
        raise ForbiddenError(f"{caller.name} may not do that", help=f"it needs {requirement}")


def _record_refusal(
    service: ServiceContext, request: Request, caller: Principal, error: ForbiddenError
) -> None:
    if request.method not in SAFE_METHODS:
        event = caller.audit_event(request.method.lower(), request.url.path)
        record_refusal(service, event, str(error))


def _has_role(*roles: UserRole) -> Permission:
    return lambda caller: not caller.roles.isdisjoint(roles)


def _may_read_metrics(caller: Principal) -> bool:
    return caller.may_read or AccessScope.METRICS in caller.scopes


def _identified_caller(service: ServiceDependency, request: Request) -> Principal:
    return identify(service, request)


IdentifiedCaller = Annotated[Principal, Depends(_identified_caller)]
"""Whoever has a session or a valid token; that they look is no use of it."""
LoggedInUser = Annotated[
    Principal, Depends(require(lambda caller: bool(caller.session), "a login"))
]
"""Somebody who has logged in, not a program."""
Reader = Annotated[Principal, Depends(require(lambda caller: caller.may_read, "a role, or read"))]
"""Any role, or a token that may read."""
RoleHolder = Annotated[Principal, Depends(require(lambda caller: bool(caller.roles), "a role"))]
"""Any role; the controller looks further."""
MetricsReader = Annotated[
    Principal, Depends(require(_may_read_metrics, "a role, or the scope metrics"))
]
"""Who may read, or measure only."""
DeveloperOnly = Annotated[
    Principal, Depends(require(_has_role(UserRole.DEVELOPER), "the role developer"))
]
AdminOnly = Annotated[Principal, Depends(require(_has_role(UserRole.ADMIN), "the role admin"))]
Auditor = Annotated[
    Principal,
    Depends(require(_has_role(UserRole.ADMIN, UserRole.DEVELOPER), "the role admin or developer")),
]
"""Who may see the audit log."""
