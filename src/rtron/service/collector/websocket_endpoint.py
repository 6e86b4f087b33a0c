"""Where guards connect: a WebSocket, with the robot's token as `Authorization: Bearer`."""

import asyncio
import logging
from contextlib import suppress

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketState

from rtron.errors import RTronError, WireError
from rtron.service.collector.close_codes import CloseCode, CloseConnectionError
from rtron.service.collector.data_collector import DataCollector
from rtron.service.collector.guard_connection import GuardConnection

log = logging.getLogger(__name__)

router = APIRouter()


@router.websocket("/link/v1")
async def guard_socket(socket: WebSocket) -> None:
    """Serve a guard; the app's state has the Collector as `collector`."""
    collector: DataCollector = socket.app.state.collector
    token = _bearer_token(socket)
    robot = await asyncio.get_running_loop().run_in_executor(
        collector.threads.tokens, collector.authenticate, token
    )
    if robot is None:
        collector.counters.unauthorised_connections += 1
        await socket.send_denial_response(PlainTextResponse("no token of a guard", 401))
        return
    if problem := _certificate_problem(collector, socket, robot):
        collector.counters.unauthorised_connections += 1
        log.warning("%s: its guard is refused: %s", robot, problem)
        await socket.send_denial_response(PlainTextResponse(problem, 403))
        return
    await socket.accept()
    collector.counters.connections += 1
    try:
        await _run_connection(collector, GuardConnection(collector, socket, robot, token))
    except CloseConnectionError as closing:
        log.warning("%s: its guard's connection is closed: %s", robot, closing.reason)
        await _close(collector, socket, closing)


def _certificate_problem(collector: DataCollector, socket: WebSocket, robot: str) -> str:
    """Return why a guard may not connect: its token alone is not enough with certificates."""
    if collector.certificates is None:
        return ""
    shown = socket.scope.get("state", {}).get("client_certificate")
    return collector.certificates.problem(shown, robot, collector.clock())


async def _run_connection(collector: DataCollector, connection: GuardConnection) -> None:
    """Serve a guard until it goes; Closing when it has to go."""
    try:
        await connection.run()
    except WebSocketDisconnect:
        return
    except WireError as error:
        collector.counters.protocol_violations += 1
        raise CloseConnectionError(CloseCode.MALFORMED, str(error)) from None
    except RTronError as error:
        raise CloseConnectionError(CloseCode.REFUSED, str(error)) from None
    except CloseConnectionError as closing:
        collector.counters.slow_connections += closing.code is CloseCode.TOO_SLOW
        collector.counters.protocol_violations += closing.code in _PROTOCOL_VIOLATIONS
        raise
    except Exception:
        log.exception("%s: its guard cannot be served", connection.robot)
        raise CloseConnectionError(CloseCode.FAILED, "the service has failed") from None


_PROTOCOL_VIOLATIONS = frozenset({CloseCode.MALFORMED, CloseCode.TOO_BIG, CloseCode.TOO_MUCH})


def _bearer_token(socket: WebSocket) -> str:
    scheme, _, token = socket.headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else ""


async def _close(
    collector: DataCollector, socket: WebSocket, closing: CloseConnectionError
) -> None:
    if socket.client_state is WebSocketState.CONNECTED:
        # The guard may have closed the connection first, or may not read.
        with suppress(RuntimeError, WebSocketDisconnect, asyncio.TimeoutError):
            sending = socket.close(closing.code, closing.reason)
            await asyncio.wait_for(sending, collector.timeouts.sending)
