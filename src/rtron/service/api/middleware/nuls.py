"""No character NUL in a path or query: PostgreSQL keeps none, and no name has one."""

from http import HTTPStatus

from starlette.types import ASGIApp, Receive, Scope, Send

from rtron.service.api.middleware.refusal import reject


class NulCheck:
    """Refuses what has one."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, as ASGI says."""
        if scope["type"] in ("http", "websocket") and _has_nul(scope):
            error = "the address has the character NUL"
            return await reject(scope, receive, send, HTTPStatus.BAD_REQUEST, error)
        return await self.app(scope, receive, send)


def _has_nul(scope: Scope) -> bool:
    return "\0" in scope["path"] or b"%00" in scope["query_string"]
