"""Changes of users and tokens: in force at once, or after a second admin has approved them."""

from sqlalchemy.orm import Session

from rtron.service.api.context import ServiceContext, audit_transaction
from rtron.service.api.schemas import PendingChangeView
from rtron.service.domain.account_changes import AccountChange, change_detail
from rtron.service.domain.principal import Principal
from rtron.service.store.accounts.account_changes import (
    apply_change,
    change_of,
    needs_approval,
    request_approval,
)
from rtron.service.store.tables import PendingChangeRow, TokenRow, UserRow


def change_account(
    service: ServiceContext, caller: Principal, change: AccountChange
) -> UserRow | TokenRow | PendingChangeView | None:
    """Put a change in force; where four eyes are needed and it gives rights, let it wait."""
    with service.database.session() as session:
        waits = service.config.four_eyes and needs_approval(session, change)
    action = f"request {change.action}" if waits else change.action
    event = caller.audit_event(action, change.name, **change_detail(change))
    with audit_transaction(service, event) as session:
        if not waits:
            return apply_change(session, service.clock(), caller.name, change)
        return pending_view(request_approval(session, service.clock(), caller.name, change))


def pending_view(row: PendingChangeRow) -> PendingChangeView:
    """Return a change that waits, as people may see it."""
    change = change_of(row)
    return PendingChangeView(
        id=row.id,
        action=change.action,
        target=change.name,
        detail=change_detail(change),
        by=row.by,
        owner=row.owner,
        created=row.created,
        expires=row.expires,
    )


def apply_approved(session: Session, service: ServiceContext, row: PendingChangeRow) -> None:
    """Put a change in force that a second admin has approved."""
    apply_change(session, service.clock(), row.by, change_of(row))
