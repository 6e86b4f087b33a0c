"""Whether the service lives, and whether it can work; for supervisors and load balancers."""

from fastapi import APIRouter
from sqlalchemy import text

from rtron.service.api.models import Health, Problem
from rtron.service.service import Served

router = APIRouter()


@router.get("/healthz")
async def healthz() -> Health:
    """Tell that the service runs."""
    return Health()


@router.get("/readyz", responses={503: {"model": Problem}})
def readyz(service: Served) -> Health:
    """Tell whether the database answers; 503 if not."""
    with service.database.session() as session:
        session.execute(text("SELECT 1"))
    return Health()
