"""Errors as the HTTP API tells them: a status and a Problem, never what was given to it."""

import logging
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse, Response

from rtron.errors import InputError, RTronError, plain_reason
from rtron.service.api.schemas import ErrorResponse, RevisionConflict
from rtron.service.domain.errors import (
    AuthenticationError,
    ConflictError,
    ForbiddenError,
    NotFoundError,
    TooManyRequestsError,
)
from rtron.service.domain.revisions import StaleRevisionError

log = logging.getLogger(__name__)

ERROR_RESPONSES: dict[int | str, dict[str, Any]] = {
    "4XX": {"model": ErrorResponse},
    "5XX": {"model": ErrorResponse},
}
"""What every endpoint may answer instead; for `include_router(responses=...)`."""

STATUS_BY_ERROR: Mapping[type[RTronError], int] = {
    AuthenticationError: HTTPStatus.UNAUTHORIZED,
    ForbiddenError: HTTPStatus.FORBIDDEN,
    NotFoundError: HTTPStatus.NOT_FOUND,
    ConflictError: HTTPStatus.CONFLICT,
    TooManyRequestsError: HTTPStatus.TOO_MANY_REQUESTS,
    InputError: HTTPStatus.UNPROCESSABLE_ENTITY,
    RTronError: HTTPStatus.SERVICE_UNAVAILABLE,
}
_MAX_ERRORS = 5


def error_response(
    status: int, error: str, help: str = "", headers: Mapping[str, str] | None = None
) -> Response:
    """Return the answer to a request that failed."""
    body = {"error": _encodable(error), "help": _encodable(help)}
    return JSONResponse(body, status_code=status, headers=headers)


def install_error_handlers(app: FastAPI) -> None:
    """Let an app answer every error with a Problem."""
    app.add_exception_handler(RTronError, _handle_service_error)
    app.add_exception_handler(StaleRevisionError, _handle_stale_revision)
    app.add_exception_handler(RequestValidationError, _handle_validation_error)
    app.add_exception_handler(HTTPException, _handle_http_error)
    app.add_exception_handler(SQLAlchemyError, _handle_database_error)
    app.add_exception_handler(IntegrityError, _handle_conflict)


def status_of(error: RTronError) -> int:
    """Return the status of HTTP for an error: that of its nearest class."""
    return next(
        int(STATUS_BY_ERROR[kind]) for kind in type(error).__mro__ if kind in STATUS_BY_ERROR
    )


async def _handle_service_error(_request: Request, error: Exception) -> Response:
    assert isinstance(error, RTronError)  # noqa: S101 - registered for it alone
    headers = {}
    if isinstance(error, AuthenticationError):
        headers["WWW-Authenticate"] = "Bearer"
    if isinstance(error, TooManyRequestsError):
        headers["Retry-After"] = str(max(1, round(error.retry_after)))
    return error_response(status_of(error), str(error), error.help, headers)


async def _handle_stale_revision(_request: Request, error: Exception) -> Response:
    assert isinstance(error, StaleRevisionError)  # noqa: S101 - registered for it alone
    conflict = RevisionConflict(error=str(error), help=error.help, newest=error.newest)
    return JSONResponse(conflict.model_dump(mode="json"), status_code=HTTPStatus.CONFLICT)


async def _handle_validation_error(_request: Request, error: Exception) -> Response:
    """Say where and what, but not the value: it may be a password."""
    assert isinstance(error, RequestValidationError)  # noqa: S101 - registered for it alone
    errors = error.errors()[:_MAX_ERRORS]
    message = "; ".join(
        f"{_field_location(each['loc'])}: {plain_reason(each['msg'])}" for each in errors
    )
    return error_response(HTTPStatus.UNPROCESSABLE_ENTITY, message, "see /openapi.json")


async def _handle_http_error(_request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 - registered for it alone
    return error_response(error.status_code, str(error.detail), headers=error.headers)


async def _handle_database_error(request: Request, error: Exception) -> Response:
    """Log the kind only: the text of such an error has the values of the statement."""
    log.error("%s: the database failed: %s", request.method, type(error).__name__)
    help = "try again; the service's log says more"
    return error_response(HTTPStatus.SERVICE_UNAVAILABLE, "the database does not answer", help)


async def _handle_conflict(_request: Request, _error: Exception) -> Response:
    help = "look again, and try again if it is still needed"
    return error_response(HTTPStatus.CONFLICT, "somebody else was faster", help)


def _encodable(text: str) -> str:
    """Leave out half surrogate pairs, which a stranger's key may have and UTF-8 has not."""
    return text.encode(errors="replace").decode()


def _field_location(location: tuple[str | int, ...]) -> str:
    return ".".join(str(part)[:100] for part in location)
