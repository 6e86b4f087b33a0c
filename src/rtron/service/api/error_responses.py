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

from rtron.errors import InputError, RTronError
from rtron.service.domain.errors import (
    ConflictError,
    ForbiddenError,
    LoginError,
    NotFoundError,
    TooManyError,
)
from rtron.service.domain.schemas import Problem

log = logging.getLogger(__name__)

PROBLEMS: dict[int | str, dict[str, Any]] = {"4XX": {"model": Problem}, "5XX": {"model": Problem}}
"""What every endpoint may answer instead; for `include_router(responses=...)`."""

STATUS: Mapping[type[RTronError], int] = {
    LoginError: HTTPStatus.UNAUTHORIZED,
    ForbiddenError: HTTPStatus.FORBIDDEN,
    NotFoundError: HTTPStatus.NOT_FOUND,
    ConflictError: HTTPStatus.CONFLICT,
    TooManyError: HTTPStatus.TOO_MANY_REQUESTS,
    InputError: HTTPStatus.UNPROCESSABLE_ENTITY,
    RTronError: HTTPStatus.SERVICE_UNAVAILABLE,
}
_MOST_FAULTS = 5


def problem(
    status: int, error: str, help: str = "", headers: Mapping[str, str] | None = None
) -> Response:
    """Return the answer to a request that failed."""
    said = {"error": _writable(error), "help": _writable(help)}
    return JSONResponse(said, status_code=status, headers=headers)


def handle_problems(app: FastAPI) -> None:
    """Let an app answer every error with a Problem."""
    app.add_exception_handler(RTronError, _ours)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(SQLAlchemyError, _database)
    app.add_exception_handler(IntegrityError, _overtaken)


def status_of(error: RTronError) -> int:
    """Return the status of HTTP for an error: that of its nearest class."""
    return next(int(STATUS[kind]) for kind in type(error).__mro__ if kind in STATUS)


async def _ours(_request: Request, error: Exception) -> Response:
    assert isinstance(error, RTronError)  # noqa: S101 - registered for it alone
    headers = {}
    if isinstance(error, LoginError):
        headers["WWW-Authenticate"] = "Bearer"
    if isinstance(error, TooManyError):
        headers["Retry-After"] = str(max(1, round(error.wait)))
    return problem(status_of(error), str(error), error.help, headers)


async def _invalid(_request: Request, error: Exception) -> Response:
    """Say where and what, but not the value: it may be a password."""
    assert isinstance(error, RequestValidationError)  # noqa: S101 - registered for it alone
    faults = error.errors()[:_MOST_FAULTS]
    said = "; ".join(f"{_place(each['loc'])}: {each['msg']}" for each in faults)
    return problem(HTTPStatus.UNPROCESSABLE_ENTITY, said, "see /openapi.json")


async def _http(_request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 - registered for it alone
    return problem(error.status_code, str(error.detail), headers=error.headers)


async def _database(request: Request, error: Exception) -> Response:
    """Log the kind only: the text of such an error has the values of the statement."""
    log.error("%s: the database failed: %s", request.method, type(error).__name__)
    help = "try again; the service's log says more"
    return problem(HTTPStatus.SERVICE_UNAVAILABLE, "the database does not answer", help)


async def _overtaken(_request: Request, _error: Exception) -> Response:
    help = "look again, and try again if it is still needed"
    return problem(HTTPStatus.CONFLICT, "somebody else was faster", help)


def _writable(text: str) -> str:
    """Leave out half surrogate pairs, which a stranger's key may have and UTF-8 has not."""
    return text.encode(errors="replace").decode()


def _place(location: tuple[str | int, ...]) -> str:
    return ".".join(str(part)[:100] for part in location)
