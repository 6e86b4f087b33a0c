"""Whether the service lives, and whether it can work; for supervisors and load balancers."""

import logging
from http import HTTPStatus

from fastapi import APIRouter
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError
from starlette.responses import JSONResponse

from rtron.service.api.models import Health, Problem
from rtron.service.service import Served

log = logging.getLogger(__name__)
router = APIRouter()


@router.get("/healthz")
async def healthz() -> Health:
    """Tell that the service runs."""
    return Health()


@router.get("/readyz", response_model=Health, responses={503: {"model": Problem}})
def readyz(service: Served) -> Health | JSONResponse:
    """Tell whether the database answers."""
    try:
        with service.database.session() as session:
            session.execute(text("SELECT 1"))
    except SQLAlchemyError:
        log.exception("the database does not answer")
        said = Problem(error="the database does not answer", help="the service's log says more")
        return JSONResponse(said.model_dump(), HTTPStatus.SERVICE_UNAVAILABLE)
    return Health()
