"""What is live, to consoles: a WebSocket that ends with the session it was opened with.

A console hears what differs of all robots (`robots`), and says of which it wants states, settings
and events: `{"robots": [names], "events": whether of all robots}`. Until then it hears all events.
"""

import asyncio
from collections.abc import Coroutine, Mapping
from contextlib import suppress

from anyio import to_thread
from fastapi import APIRouter, WebSocket
from pydantic import Field, ValidationError
from sqlalchemy.exc import SQLAlchemyError
from starlette.websockets import WebSocketDisconnect, WebSocketState

from rtron.errors import RTronError
from rtron.service.api.auth.authentication import identify
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import Principal
from rtron.service.domain.schemas import Name, RequestModel
from rtron.service.live.console_listener import ConsoleListener, Interest

router = APIRouter()

_POLICY_VIOLATION = 1008
_TRY_AGAIN = 1013
_SESSION_CHECK_INTERVAL_S = 1.0
_CHANGES_INTERVAL_S = 0.5
_MAX_SOCKETS = 200
_MAX_OWN_SOCKETS = 50
"""Of one user or token, which so keeps nobody else out."""
_MAX_WATCHED = 50
_REQUEST_INTERVAL_S = 0.1
"""So long after one request of a console the next one is read: each may take 50 whole states."""


class WatchRequest(RequestModel):
    """What a console wants to hear."""

    robots: list[Name] = Field(max_length=_MAX_WATCHED)
    events: bool


@router.websocket("/live")
async def live_socket(socket: WebSocket, service: ServiceDependency) -> None:
    """Tell live messages until the session or the token ends, or the console is too slow."""
    try:
        caller = await to_thread.run_sync(_check_read_permission, service, socket)
    except RTronError as error:
        return await socket.close(_POLICY_VIOLATION, str(error)[:100])
    sockets: dict[WebSocket, str] = socket.app.state.sockets
    if not _has_capacity(sockets, caller):
        return await socket.close(_TRY_AGAIN, "too many consoles")
    sockets[socket] = caller.name
    try:
        await socket.accept()
        listener = ConsoleListener(service.hub)
        with listener:
            await _run_until_first(
                _send_messages(socket, listener),
                _send_changes(socket, listener),
                _take_requests(socket, listener),
                _watch_session(socket, service),
            )
    finally:
        del sockets[socket]
        await _close_socket(socket)


def _has_capacity(sockets: Mapping[WebSocket, str], caller: Principal) -> bool:
    own = sum(name == caller.name for name in sockets.values())
    return len(sockets) < _MAX_SOCKETS and own < _MAX_OWN_SOCKETS


def _check_read_permission(service: ServiceContext, socket: WebSocket) -> Principal:
    caller = identify(service, socket)
    if not caller.may_read:
        raise ForbiddenError("the token may not read")
    return caller


async def _send_messages(socket: WebSocket, listener: ConsoleListener) -> None:
    async for message in listener:
        await socket.send_json(message)


async def _send_changes(socket: WebSocket, listener: ConsoleListener) -> None:
    while True:
        if changes := listener.take_changes():
            await socket.send_json({"type": "robots", "robots": changes})
        await asyncio.sleep(_CHANGES_INTERVAL_S)


async def _take_requests(socket: WebSocket, listener: ConsoleListener) -> None:
    """Do what the console asks for until it has gone; ignore what is no request."""
    while (message := await socket.receive())["type"] != "websocket.disconnect":
        with suppress(ValidationError):
            request = WatchRequest.model_validate_json(message.get("text") or "")
            listener.watch(Interest(robots=frozenset(request.robots), events=request.events))
        await asyncio.sleep(_REQUEST_INTERVAL_S)


async def _watch_session(socket: WebSocket, service: ServiceContext) -> None:
    """Wait until the session is over: logged out, disabled, removed, revoked or too old."""
    with suppress(RTronError):  # raised when the session is over
        while True:
            await asyncio.sleep(_SESSION_CHECK_INTERVAL_S)
            with suppress(SQLAlchemyError):  # it is away: no reason to end what is live
                await to_thread.run_sync(_check_read_permission, service, socket)


async def _run_until_first(*coroutines: Coroutine[None, None, None]) -> None:
    """Do these things at once until one of them ends."""
    tasks = [asyncio.ensure_future(work) for work in coroutines]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            with suppress(WebSocketDisconnect, RuntimeError):  # the console closed it first
                task.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _close_socket(socket: WebSocket) -> None:
    if socket.application_state is WebSocketState.CONNECTED:
        with suppress(RuntimeError, WebSocketDisconnect):  # the console closed it first
            await socket.close(_POLICY_VIOLATION, "the session is over, or the console too slow")
