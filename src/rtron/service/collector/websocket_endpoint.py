"""Where guards connect: a WebSocket, with the robot's token as `Authorization: Bearer`."""

import asyncio
import logging
from contextlib import suppress

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketState

from rtron.errors import RTronError, WireError
from rtron.service.collector.close_codes import CloseCode, Closing
from rtron.service.collector.data_collector import Collector
from rtron.service.collector.guard_connection import Connection

log = logging.getLogger(__name__)

router = APIRouter()


@router.websocket("/link/v1")
async def link(socket: WebSocket) -> None:
    """Serve a guard; the app's state has the Collector as `collector`."""
    collector: Collector = socket.app.state.collector
    token = _token(socket)
    robot = await asyncio.to_thread(collector.authenticate, token)
    if robot is None:
        collector.tally.unauthorised += 1
        await socket.send_denial_response(PlainTextResponse("no token of a guard", 401))
        return
    await socket.accept()
    collector.tally.connected += 1
    try:
        await _talk(collector, Connection(collector, socket, robot, token))
    except Closing as closing:
        log.warning("%s: its guard's connection is closed: %s", robot, closing.reason)
        await _close(collector, socket, closing)


async def _talk(collector: Collector, connection: Connection) -> None:
    """Serve a guard until it goes; Closing when it has to go."""
    try:
        await connection.run()
    except WebSocketDisconnect:
        return
    except WireError as error:
        collector.tally.refused += 1
        raise Closing(CloseCode.MALFORMED, str(error)) from None
    except RTronError as error:
        raise Closing(CloseCode.REFUSED, str(error)) from None
    except Closing as closing:
        collector.tally.slow += closing.code is CloseCode.TOO_SLOW
        collector.tally.refused += closing.code in _REFUSALS
        raise
    except Exception:
        log.exception("%s: its guard cannot be served", connection.robot)
        raise Closing(CloseCode.FAILED, "the service has failed") from None


_REFUSALS = frozenset({CloseCode.MALFORMED, CloseCode.TOO_BIG, CloseCode.TOO_MUCH})


def _token(socket: WebSocket) -> str:
    scheme, _, token = socket.headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else ""


async def _close(collector: Collector, socket: WebSocket, closing: Closing) -> None:
    if socket.client_state is WebSocketState.CONNECTED:
        with suppress(RuntimeError, WebSocketDisconnect, asyncio.TimeoutError):
            sending = socket.close(closing.code, closing.reason)
            await asyncio.wait_for(sending, collector.patience.sending)
