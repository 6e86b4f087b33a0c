"""Whether the service lives, and whether it can work; for supervisors and load balancers."""

from fastapi import APIRouter
from sqlalchemy import delete

from rtron.service.api.context import Served
from rtron.service.domain.schemas import Health, Problem
from rtron.service.store.accounts.last_use import briefly
from rtron.service.store.tables import AuditRow

router = APIRouter()

_PATIENCE_MS = 2000


@router.get("/healthz")
async def healthz() -> Health:
    """Tell that the service runs."""
    return Health()


@router.get("/readyz", responses={503: {"model": Problem}})
def readyz(service: Served) -> Health:
    """Tell whether the database can be written; 503 if not. The row that is tried is not kept."""
    with briefly(service.database, _PATIENCE_MS) as session:
        row = AuditRow(
            at=service.clock(), who="", address="", action="", target="", detail={}, outcome=""
        )
        session.add(row)
        session.flush()
        session.execute(delete(AuditRow).where(AuditRow.id == row.id))
    return Health()
