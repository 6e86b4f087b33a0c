"""The audit log, a page at a time."""

from typing import Annotated

from fastapi import APIRouter, Query
from sqlalchemy import select

from rtron.service.api.auth.authorization import Auditor
from rtron.service.api.context import ServiceDependency
from rtron.service.api.schemas import AuditEntry, AuditPage
from rtron.service.store.tables import AuditRow

router = APIRouter()

Text = Annotated[str | None, Query(max_length=300)]
Id = Annotated[int | None, Query(ge=1, le=(1 << 63) - 1)]
Limit = Annotated[int, Query(ge=1, le=1000)]


@router.get("/audit")
def list_audit_entries(
    _caller: Auditor,
    service: ServiceDependency,
    *,
    who: Text = None,
    action: Text = None,
    target: Text = None,
    before: Id = None,
    limit: Limit = 100,
) -> AuditPage:
    """Return who did what, newest first; `before` is the `next` of the page before."""
    query = select(AuditRow).order_by(AuditRow.id.desc()).limit(limit + 1)
    filters = {AuditRow.who: who, AuditRow.action: action, AuditRow.target: target}
    for column, value in filters.items():
        if value is not None:
            query = query.where(column == value)
    if before is not None:
        query = query.where(AuditRow.id < before)
    with service.database.session() as session:
        rows = session.scalars(query).all()
    entries = [AuditEntry.model_validate(row, from_attributes=True) for row in rows[:limit]]
    return AuditPage(entries=entries, next=entries[-1].id if len(rows) > limit else None)
