"""Who may call what: dependencies of the endpoints. Refused changes are in the audit log."""

from collections.abc import Callable
from typing import Annotated

from fastapi import Depends, Request

from rtron.service.api.audit_transaction import note_refused
from rtron.service.api.auth.authentication import (
    SAFE_METHODS,
    Caller,
    caller_of,
    check_csrf,
    watcher_of,
)
from rtron.service.api.context import Served, Service
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.schemas import Scope, UserRole

__all__ = [
    "AdminOnly",
    "Auditor",
    "Caller",
    "DeveloperOnly",
    "Known",
    "Measurer",
    "Member",
    "Person",
    "Reader",
    "Watcher",
]

Allowed = Callable[[Caller], bool]


def _allow(allowed: Allowed, needed: str) -> Callable[[Service, Request], Caller]:
    """Make the dependency that gives the caller if `allowed`, else raises ForbiddenError."""

    def check(service: Served, request: Request) -> Caller:
        caller = caller_of(service, request)
        try:
            check_csrf(caller, request)
            _check(caller, allowed, needed)
        except ForbiddenError as error:
            _note(service, request, caller, error)
            raise
        return caller

    return check


def _check(caller: Caller, allowed: Allowed, needed: str) -> None:
    if not allowed(caller):
        raise ForbiddenError(f"{caller.name} may not do that", help=f"it needs {needed}")


def _note(service: Service, request: Request, caller: Caller, error: ForbiddenError) -> None:
    if request.method not in SAFE_METHODS:
        deed = caller.deed(request.method.lower(), request.url.path)
        note_refused(service, deed, str(error))


def _is(*roles: UserRole) -> Allowed:
    return lambda caller: not caller.roles.isdisjoint(roles)


def _may_measure(caller: Caller) -> bool:
    return caller.may_read or Scope.METRICS in caller.scopes


def _watcher(service: Served, request: Request) -> Caller:
    return watcher_of(service, request)


Watcher = Annotated[Caller, Depends(_watcher)]
"""Whoever has a session or a valid token; that they look is no use of it."""
Known = Annotated[Caller, Depends(_allow(lambda caller: True, ""))]
"""Whoever has a session or a valid token."""
Person = Annotated[Caller, Depends(_allow(lambda caller: bool(caller.session), "a login"))]
"""Somebody who has logged in, not a program."""
Reader = Annotated[Caller, Depends(_allow(lambda caller: caller.may_read, "a role, or read"))]
"""Any role, or a token that may read."""
Member = Annotated[Caller, Depends(_allow(lambda caller: bool(caller.roles), "a role"))]
"""Any role; the controller looks further."""
Measurer = Annotated[Caller, Depends(_allow(_may_measure, "a role, or the scope metrics"))]
"""Who may read, or measure only."""
DeveloperOnly = Annotated[Caller, Depends(_allow(_is(UserRole.DEVELOPER), "the role developer"))]
AdminOnly = Annotated[Caller, Depends(_allow(_is(UserRole.ADMIN), "the role admin"))]
Auditor = Annotated[
    Caller, Depends(_allow(_is(UserRole.ADMIN, UserRole.DEVELOPER), "the role admin or developer"))
]
"""Who may see the audit log."""
