"""Who may call what: dependencies of the endpoints. Refused changes are in the audit log."""

import asyncio
from collections.abc import Callable
from typing import Annotated

from fastapi import Depends, Request

from rtron.service.api.auth.authentication import SAFE_METHODS, authenticate, check_csrf, identify
from rtron.service.api.context import ServiceContext, ServiceDependency, record_refusal
from rtron.service.domain.authority.leases import may_command
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import (
    AccessScope,
    Principal,
    SessionStage,
    UserRole,
    check_reach,
)
from rtron.service.store.fleet.labels import labels_of

__all__ = [
    "AdminOnly",
    "Auditor",
    "CodeAwaited",
    "CommandingPerson",
    "DeveloperOnly",
    "EnrollingUser",
    "IdentifiedCaller",
    "LoggedInUser",
    "MetricsReader",
    "Principal",
    "Reader",
    "RoleHolder",
    "SessionHolder",
    "StoppingCaller",
    "TokenHolder",
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
            _check_named_robot(service, caller, request)
        except ForbiddenError as error:
            _record_refusal(service, request, caller, error)
            raise
        return caller

    return check


def _check_permission(caller: Principal, permission: Permission, requirement: str) -> None:
    if not permission(caller):
        raise ForbiddenError(f"{caller.name} may not do that", help=f"it needs {requirement}")


def _check_named_robot(service: ServiceContext, caller: Principal, request: Request) -> None:
    """Whoever is limited to groups changes no other robot, on whatever path it is named."""
    robot = request.path_params.get("robot")
    if robot is not None and request.method not in SAFE_METHODS:
        check_group(service, caller, robot)


def check_group(service: ServiceContext, caller: Principal, robot: str) -> None:
    """Raise ForbiddenError for a robot that is in no group of a caller who is limited to some."""
    if caller.groups is not None:
        with service.database.session() as session:
            check_reach(caller, robot, labels_of(session, robot))


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


async def _stopping_caller(service: ServiceDependency, request: Request) -> Principal:
    loop = asyncio.get_running_loop()
    return await loop.run_in_executor(service.stop_threads, _check_role_holder, service, request)


def _identified_caller(service: ServiceDependency, request: Request) -> Principal:
    return identify(service, request)


IdentifiedCaller = Annotated[Principal, Depends(_identified_caller)]
"""Whoever has a session or a valid token; that they look is no use of it."""
LoggedInUser = Annotated[
    Principal, Depends(require(lambda caller: caller.has_stage(SessionStage.COMPLETE), "a login"))
]
"""Somebody who has logged in, not a program."""
SessionHolder = Annotated[
    Principal, Depends(require(lambda caller: bool(caller.session), "a session"))
]
"""Somebody who has logged in, or has to show a code yet."""
CodeAwaited = Annotated[
    Principal, Depends(require(lambda caller: caller.has_stage(SessionStage.CODE), "a begun login"))
]
"""Somebody who has shown the password, and has to show a code."""
EnrollingUser = Annotated[
    Principal,
    Depends(
        require(
            lambda c: c.has_stage(SessionStage.COMPLETE) or c.has_stage(SessionStage.ENROLMENT),
            "a login",
        )
    ),
]
"""Somebody who may enrol a second factor, or has to before anything else."""
TokenHolder = Annotated[
    Principal,
    Depends(
        require(
            lambda caller: bool(caller.scopes) and AccessScope.GUARD not in caller.scopes,
            "a program's token",
        )
    ),
]
"""A program, with whatever token; a guard renews its own on its link, where it is looked at."""
Reader = Annotated[Principal, Depends(require(lambda caller: caller.may_read, "a role, or read"))]
"""Any role, or a token that may read."""
_check_role_holder = require(lambda caller: bool(caller.roles), "a role")
RoleHolder = Annotated[Principal, Depends(_check_role_holder)]
"""Any role; the controller looks further."""
StoppingCaller = Annotated[Principal, Depends(_stopping_caller)]
"""Any role, found out in the threads of the emergency stop."""
MetricsReader = Annotated[
    Principal, Depends(require(_may_read_metrics, "a role, or the scope metrics"))
]
"""Who may read, or measure only."""
CommandingPerson = Annotated[
    Principal, Depends(require(may_command, "a login with the role end_user or developer"))
]
"""Who may say who is in command of a robot."""
DeveloperOnly = Annotated[
    Principal, Depends(require(_has_role(UserRole.DEVELOPER), "the role developer"))
]
AdminOnly = Annotated[Principal, Depends(require(_has_role(UserRole.ADMIN), "the role admin"))]
Auditor = Annotated[
    Principal,
    Depends(require(_has_role(UserRole.ADMIN, UserRole.DEVELOPER), "the role admin or developer")),
]
"""Who may see the audit log."""
