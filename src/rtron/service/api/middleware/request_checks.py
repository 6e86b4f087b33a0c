"""Requests that are refused: of other sites' pages (CSRF), for other hosts, and with NUL."""

from http import HTTPStatus
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocketClose

from rtron.service.api.auth.authentication import SAFE_METHODS
from rtron.service.api.error_responses import error_response

_OWN_FETCH_SITES = ("same-origin", "none")


class OriginCheck:
    """Lets WebSockets and changes pass that come from the service's own pages, or from programs."""

    def __init__(self, app: ASGIApp, schemes: frozenset[str]) -> None:
        self.app = app
        self.schemes = schemes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, as ASGI says."""
        if not _needs_check(scope) or self._is_allowed_origin(Headers(scope=scope)):
            return await self.app(scope, receive, send)
        error, help = "that is a page of another site", "use the console of this address"
        return await reject(scope, receive, send, HTTPStatus.FORBIDDEN, error, help)

    def _is_allowed_origin(self, headers: Headers) -> bool:
        if headers.get("sec-fetch-site", "none") not in _OWN_FETCH_SITES:
            return False
        origin = headers.get("origin")
        if origin is None:
            is_browser = "upgrade" in headers and "authorization" not in headers
            return not is_browser
        return self._is_same_origin(origin, headers.get("host", ""))

    def _is_same_origin(self, origin: str, host: str) -> bool:
        try:
            parts = urlsplit(origin)
        except ValueError:
            return False
        return parts.scheme in self.schemes and parts.netloc.lower() == host.lower()


def _needs_check(scope: Scope) -> bool:
    if scope["type"] == "http":
        return scope["method"] not in SAFE_METHODS
    return bool(scope["type"] == "websocket")


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


_POLICY_VIOLATION = 1008


async def reject(
    scope: Scope, receive: Receive, send: Send, status: int, error: str, help: str = ""
) -> None:
    """Answer with a Problem, or do not accept the WebSocket."""
    if scope["type"] == "websocket":
        return await WebSocketClose(_POLICY_VIOLATION, error)(scope, receive, send)
    headers = {"Connection": "close"}
    return await error_response(status, error, help, headers)(scope, receive, send)
