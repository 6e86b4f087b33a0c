"""Requests are for this service by one of its names, or refused: no DNS name of a stranger's."""

from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from rtron.service.api.middleware.refusal import reject


class HostCheck:
    """Lets pass what names one of `names` (small letters) in its Host header."""

    def __init__(self, app: ASGIApp, names: frozenset[str]) -> None:
        self.app = app
        self.names = names

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, as ASGI says."""
        if scope["type"] not in ("http", "websocket") or self._is_known_host(Headers(scope=scope)):
            return await self.app(scope, receive, send)
        error, help = "there is no such host here", "rtron serve --allow-host NAME"
        return await reject(scope, receive, send, HTTPStatus.MISDIRECTED_REQUEST, error, help)

    def _is_known_host(self, headers: Headers) -> bool:
        host_headers = headers.getlist("host")
        return len(host_headers) == 1 and parse_host_name(host_headers[0]) in self.names


def parse_host_name(host: str) -> str:
    """Return the name in a Host header, without port and brackets, in small letters."""
    name, colon, port = host.rpartition(":")
    if not colon or not (port.isdigit() and port.isascii()) or name.endswith(":"):
        name = host
    if name.startswith("[") and name.endswith("]"):
        name = name[1:-1]
    return name.lower()
