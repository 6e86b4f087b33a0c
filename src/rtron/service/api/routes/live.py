"""What is live, to consoles: a WebSocket that ends with the session it was opened with."""

import asyncio
from collections.abc import Coroutine
from contextlib import suppress

from anyio import to_thread
from fastapi import APIRouter, WebSocket
from sqlalchemy.exc import SQLAlchemyError
from starlette.websockets import WebSocketDisconnect, WebSocketState

from rtron.errors import RTronError
from rtron.service.api.auth.authentication import identify
from rtron.service.api.context import ServiceContext, ServiceDependency
from rtron.service.domain.errors import ForbiddenError

router = APIRouter()

_POLICY_VIOLATION = 1008
_TRY_AGAIN = 1013
_SESSION_CHECK_INTERVAL_S = 1.0
_MAX_SOCKETS = 200


@router.websocket("/live")
async def live_socket(socket: WebSocket, service: ServiceDependency) -> None:
    """Tell live messages until the session or the token ends, or the console is too slow."""
    try:
        await to_thread.run_sync(_check_read_permission, service, socket)
    except RTronError as error:
        return await socket.close(_POLICY_VIOLATION, str(error)[:100])
    if not _has_capacity(socket):
        return await socket.close(_TRY_AGAIN, "too many consoles")
    await socket.accept()
    sockets = socket.app.state.sockets
    sockets.add(socket)
    try:
        await _run_until_first(
            _send_messages(socket, service),
            _wait_for_disconnect(socket),
            _watch_session(socket, service),
        )
    finally:
        sockets.discard(socket)
        await _close_socket(socket)


def _has_capacity(socket: WebSocket) -> bool:
    return len(socket.app.state.sockets) < _MAX_SOCKETS


def _check_read_permission(service: ServiceContext, socket: WebSocket) -> None:
    caller = identify(service, socket)
    if not caller.may_read:
        raise ForbiddenError("the token may not read")


async def _send_messages(socket: WebSocket, service: ServiceContext) -> None:
    with service.hub.listen() as listener:
        async for message in listener:
            await socket.send_json(message)


async def _wait_for_disconnect(socket: WebSocket) -> None:
    """Wait until the console has gone; ignore what it sends."""
    while (await socket.receive())["type"] != "websocket.disconnect":
        pass  # a console has nothing to say here


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
