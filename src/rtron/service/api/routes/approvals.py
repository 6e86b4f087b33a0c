"""Changes of rights that wait for a second admin: shown, approved, rejected."""

from fastapi import APIRouter

from rtron.service.api.account_change_requests import apply_approved, pending_view
from rtron.service.api.auth.authorization import AdminOnly
from rtron.service.api.context import (
    ServiceContext,
    ServiceDependency,
    audit_transaction,
    record_refusal,
)
from rtron.service.api.schemas import PendingChangeView
from rtron.service.domain.errors import ForbiddenError, NotFoundError
from rtron.service.domain.principal import Principal
from rtron.service.store.accounts.account_changes import pending_changes, take_pending

router = APIRouter(prefix="/approvals")


@router.get("")
def list_pending(_caller: AdminOnly, service: ServiceDependency) -> list[PendingChangeView]:
    """Return the changes that wait, the oldest first."""
    with service.database.session() as session:
        return [pending_view(row) for row in pending_changes(session, service.clock())]


@router.post("/{id}", status_code=204)
def approve(id: int, caller: AdminOnly, service: ServiceDependency) -> None:
    """Put a change in force that another admin has requested."""
    pending = _find(service, id)
    event = caller.audit_event(
        f"approve {pending.action}", pending.target, **pending.detail, requested_by=pending.by
    )
    try:
        _check_second_admin(caller, pending)
    except ForbiddenError as error:
        record_refusal(service, event, str(error))
        raise
    with audit_transaction(service, event) as session:
        apply_approved(session, service, take_pending(session, service.clock(), id))


@router.delete("/{id}", status_code=204)
def reject(id: int, caller: AdminOnly, service: ServiceDependency) -> None:
    """Drop a change that waits; who has requested it may do that too."""
    pending = _find(service, id)
    event = caller.audit_event(f"reject {pending.action}", pending.target, requested_by=pending.by)
    with audit_transaction(service, event) as session:
        take_pending(session, service.clock(), id)


def _find(service: ServiceContext, id: int) -> PendingChangeView:
    with service.database.session() as session:
        for row in pending_changes(session, service.clock()):
            if row.id == id:
                return pending_view(row)
    raise NotFoundError(f"no change {id} waits", help="somebody was faster, or it is over")


def _check_second_admin(caller: Principal, pending: PendingChangeView) -> None:
    """Raise ForbiddenError for who has requested the change, and for programs: they have no eyes.

    A token of the one who has requested it would be the same person.
    """
    if not caller.session:
        raise ForbiddenError("a token cannot approve", help="log in as another admin")
    if caller.name in (pending.by, pending.owner):
        raise ForbiddenError("you have requested this yourself", help="ask another admin")
