"""Whether the service lives, and whether it can work; for supervisors and load balancers."""

from fastapi import APIRouter
from sqlalchemy import delete

from rtron.service.api.context import ServiceDependency
from rtron.service.domain.schemas import ErrorResponse, Health
from rtron.service.store.accounts.last_use import short_transaction
from rtron.service.store.tables import AuditRow

router = APIRouter()

_LOCK_TIMEOUT_MS = 2000


@router.get("/healthz")
async def healthz() -> Health:
    """Tell that the service runs."""
    return Health()


@router.get("/readyz", responses={503: {"model": ErrorResponse}})
def readyz(service: ServiceDependency) -> Health:
    """Tell whether the database can be written; 503 if not. The row that is tried is not kept."""
    with short_transaction(service.database, _LOCK_TIMEOUT_MS) as session:
        row = AuditRow(
            at=service.clock(), who="", address="", action="", target="", detail={}, outcome=""
        )
        session.add(row)
        session.flush()
        session.execute(delete(AuditRow).where(AuditRow.id == row.id))
    return Health()
