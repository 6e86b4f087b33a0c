"""What nobody foresaw is logged here and told as a Problem without its insides."""

import logging
from http import HTTPStatus

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from rtron.service.api.middleware.refusal import reject

log = logging.getLogger(__name__)


class InternalErrorHandler:
    """Answers 500 where the app raised an exception; the log has the traceback."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, as ASGI says."""
        if scope["type"] != "http":
            return await self.app(scope, receive, send)
        has_started = False

        async def sending(message: Message) -> None:
            nonlocal has_started
            has_started = True
            await send(message)

        try:
            await self.app(scope, receive, sending)
        except Exception:
            log.exception("%s %s failed", scope["method"], ascii(scope["path"][:200]))
            if has_started:
                raise
            help = "the service's log says more"
            await reject(scope, receive, send, HTTPStatus.INTERNAL_SERVER_ERROR, "it failed", help)
