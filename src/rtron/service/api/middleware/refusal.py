"""How a gate says no, to a request and to a WebSocket."""

from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocketClose

from rtron.service.api.error_responses import error_response

_POLICY_VIOLATION = 1008


async def reject(
    scope: Scope, receive: Receive, send: Send, status: int, error: str, help: str = ""
) -> None:
    """Answer with a Problem, or do not accept the WebSocket."""
    if scope["type"] == "websocket":
        return await WebSocketClose(_POLICY_VIOLATION, error)(scope, receive, send)
    headers = {"Connection": "close"}
    return await error_response(status, error, help, headers)(scope, receive, send)
