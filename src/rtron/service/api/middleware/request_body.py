"""Bodies of requests: read whole within a bound and a time before anybody looks into them."""

import re
from contextlib import AsyncExitStack
from http import HTTPStatus
from itertools import accumulate

from anyio import fail_after, to_thread
from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from rtron.errors import RTronError
from rtron.service.api.auth.authentication import SAFE_METHODS, check_csrf, identify
from rtron.service.api.context import service_context
from rtron.service.api.error_responses import status_of
from rtron.service.api.middleware.request_checks import reject
from rtron.service.domain.principal import Principal, UserRole

MAX_DEPTH = 40
"""The most lists and objects within each other."""
_CHUNK_BYTES = 1 << 16
_SMALL_BYTES = 1 << 12
"""What is checked without a thread: it takes less than to wait for one, as a stop must not."""
_NON_BRACKETS = bytes(byte for byte in range(256) if byte not in b"[]{}")
_DEPTH_CHANGE = {ord("["): 1, ord("{"): 1, ord("]"): -1, ord("}"): -1}


def is_too_deep(document: bytes | bytearray) -> bool:
    """Tell whether more than `MAX_DEPTH` brackets of a JSON document are open at once; linear.

    It works in slices, between which other threads go on.
    """
    if document.count(b"[") + document.count(b"{") <= MAX_DEPTH:
        return False
    bare = document.replace(b"\\\\", b"").replace(b'\\"', b"")
    depth = in_string = 0
    for begin in range(0, len(bare), _CHUNK_BYTES):
        parts = bare[begin : begin + _CHUNK_BYTES].split(b'"')
        brackets = b"".join(parts[in_string::2]).translate(None, _NON_BRACKETS)
        depths = list(accumulate(map(_DEPTH_CHANGE.__getitem__, brackets), initial=depth))
        if max(depths) > MAX_DEPTH:
            return True
        depth = depths[-1]
        in_string ^= (len(parts) - 1) & 1
    return False


MAX_STRANGER_BYTES = 1 << 16
"""The most bytes of a body of who shows no login and no token: very many may come at once."""
MAX_BODY_BYTES = 1 << 20
"""The most bytes of a body."""
MAX_GRAPH_BYTES = 16 << 20
"""The most bytes of an interaction graph."""
_GRAPH_PATH = re.compile(r"/api/v1/robots/[^/]+/graph")


class _RefusedError(Exception):
    def __init__(self, status: int, error: str) -> None:
        super().__init__(error)
        self.status = status


class RequestBodyLimit:
    """Gives the app a body that is there, or refuses it; `timeout_s` is in seconds.

    A large one is read only from who may upload one, and one at a time; one that is not small only
    from who is logged in, or has a token.
    """

    def __init__(self, app: ASGIApp, timeout_s: float = 20.0) -> None:
        self.app = app
        self.timeout_s = timeout_s
        self.has_large_body = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, as ASGI says."""
        if scope["type"] != "http" or scope["method"] in SAFE_METHODS:
            return await self.app(scope, receive, send)
        async with AsyncExitStack() as stack:
            try:
                with fail_after(self.timeout_s):
                    body = await self._read_body(scope, receive, stack)
            except TimeoutError:
                slow = "the body came too slowly"
                return await reject(scope, receive, send, HTTPStatus.REQUEST_TIMEOUT, slow)
            except _RefusedError as error:
                return await reject(scope, receive, send, error.status, str(error))
            if body is None:
                return None
            return await self.app(scope, _replay(body, receive), send)

    async def _read_body(
        self, scope: Scope, receive: Receive, stack: AsyncExitStack
    ) -> bytes | None:
        """Return the body, None if the other side has gone."""
        max_bytes = MAX_GRAPH_BYTES if _is_graph_upload(scope) else MAX_BODY_BYTES
        length = int(Headers(scope=scope).get("content-length", "0"))
        admitted = await self._admit(scope, stack, length, MAX_STRANGER_BYTES, max_bytes)
        body, more = bytearray(), True
        while more:
            message = await receive()
            if message["type"] == "http.disconnect":
                return None
            body += message.get("body", b"")
            more = message.get("more_body", False)
            admitted = await self._admit(scope, stack, len(body), admitted, max_bytes)
        if len(body) <= _SMALL_BYTES:
            _check_content(body)
        else:
            await to_thread.run_sync(_check_content, body)
        return bytes(body)

    async def _admit(
        self, scope: Scope, stack: AsyncExitStack, size: int, admitted: int, max_bytes: int
    ) -> int:
        """Return how many bytes may come without another look at who sends them."""
        if size > max_bytes:
            raise _too_large_error(max_bytes)
        if size <= admitted:
            return admitted
        if size <= MAX_BODY_BYTES:
            await to_thread.run_sync(_check_sender, scope)
            return MAX_BODY_BYTES
        await to_thread.run_sync(_check_uploader, scope)
        if self.has_large_body:
            raise _RefusedError(HTTPStatus.SERVICE_UNAVAILABLE, "another large body comes just now")
        self.has_large_body = True
        stack.callback(self._release_large_body)
        return max_bytes

    def _release_large_body(self) -> None:
        self.has_large_body = False


def _check_sender(scope: Scope) -> Principal:
    request = Request(scope)
    try:
        caller = identify(service_context(request), request)
        check_csrf(caller, request)
    except RTronError as error:
        raise _RefusedError(status_of(error), str(error)) from None
    return caller


def _check_uploader(scope: Scope) -> None:
    caller = _check_sender(scope)
    if UserRole.DEVELOPER not in caller.roles:
        raise _RefusedError(HTTPStatus.FORBIDDEN, f"{caller.name} may upload no graph")


def _check_content(body: bytearray) -> None:
    """Refuse what parsers would recurse into, and the character that PostgreSQL cannot keep."""
    if is_too_deep(body):
        raise _RefusedError(HTTPStatus.BAD_REQUEST, "lists and objects are nested too deeply")
    if b"\\u0000" in body or b"\0" in body:
        raise _RefusedError(HTTPStatus.BAD_REQUEST, "a text has the character NUL")


def _is_graph_upload(scope: Scope) -> bool:
    return scope["method"] == "PUT" and bool(_GRAPH_PATH.fullmatch(scope["path"]))


def _too_large_error(max_bytes: int) -> _RefusedError:
    return _RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {max_bytes >> 20} MiB")


def _replay(body: bytes, receive: Receive) -> Receive:
    """Return a `receive` that gives the whole body, and then what comes after it."""
    is_sent = False

    async def receive_body() -> Message:
        nonlocal is_sent
        if is_sent:
            return await receive()
        is_sent = True
        return {"type": "http.request", "body": body, "more_body": False}

    return receive_body
