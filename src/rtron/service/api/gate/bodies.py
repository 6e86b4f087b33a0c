"""Bodies of requests: read whole within a bound and a time before anybody looks into them."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http import HTTPStatus

from anyio import fail_after, to_thread
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from rtron.service.api.credentials import SAFE_METHODS
from rtron.service.api.gate.nesting import is_too_deep
from rtron.service.api.gate.refusal import refuse

MOST = 1 << 20
"""The most bytes of a body."""
MOST_OF_GRAPH = 16 << 20
"""The most bytes of an interaction graph."""
_GRAPH = re.compile(r"/api/v1/robots/[^/]+/graph")
_LARGE_AT_A_TIME = 4


class _RefusedError(Exception):
    def __init__(self, status: HTTPStatus, error: str) -> None:
        super().__init__(error)
        self.status = status


class Bodies:
    """Gives the app a body that is there, or refuses it; `patience` is in seconds.

    Only a few large ones are read at a time, since they are read before it is known from whom.
    """

    def __init__(self, app: ASGIApp, patience: float = 20.0) -> None:
        self.app = app
        self.patience = patience
        self.large = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, as ASGI says."""
        if scope["type"] != "http" or scope["method"] in SAFE_METHODS:
            return await self.app(scope, receive, send)
        try:
            with fail_after(self.patience):
                body = await self._body(scope, receive)
        except TimeoutError:
            slow = "the body came too slowly"
            return await refuse(scope, receive, send, HTTPStatus.REQUEST_TIMEOUT, slow)
        except _RefusedError as error:
            return await refuse(scope, receive, send, error.status, str(error))
        if body is None:
            return None
        return await self.app(scope, _replayed(body, receive), send)

    async def _body(self, scope: Scope, receive: Receive) -> bytes | None:
        """Return the body, None if the other side has gone."""
        most = MOST_OF_GRAPH if _is_graph(scope) else MOST
        length = Headers(scope=scope).get("content-length", "0")
        if int(length) > most:
            raise _too_large(most)
        body = await self._read(receive, most)
        if body:
            await to_thread.run_sync(_check, body)
        return body

    async def _read(self, receive: Receive, most: int) -> bytes | None:
        body, more = bytearray(), True
        with self._counted() as count:
            while more:
                message = await receive()
                if message["type"] == "http.disconnect":
                    return None
                body += message.get("body", b"")
                more = message.get("more_body", False)
                if len(body) > most:
                    raise _too_large(most)
                if len(body) > MOST:
                    count()
        return bytes(body)

    @contextmanager
    def _counted(self) -> Iterator[Callable[[], None]]:
        """Give a function that counts a body among the large ones, once, if there is place."""
        counted = False

        def count() -> None:
            nonlocal counted
            if not counted and self.large >= _LARGE_AT_A_TIME:
                raise _RefusedError(HTTPStatus.SERVICE_UNAVAILABLE, "too many large bodies now")
            self.large += not counted
            counted = True

        try:
            yield count
        finally:
            self.large -= counted


def _check(body: bytes) -> None:
    """Refuse what parsers would recurse into, and the character that PostgreSQL cannot keep."""
    if is_too_deep(body):
        raise _RefusedError(HTTPStatus.BAD_REQUEST, "lists and objects are nested too deeply")
    if b"\\u0000" in body or b"\0" in body:
        raise _RefusedError(HTTPStatus.BAD_REQUEST, "a text has the character NUL")


def _is_graph(scope: Scope) -> bool:
    return scope["method"] == "PUT" and bool(_GRAPH.fullmatch(scope["path"]))


def _too_large(most: int) -> _RefusedError:
    return _RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"more than {most >> 20} MiB")


def _replayed(body: bytes, receive: Receive) -> Receive:
    """Return a `receive` that gives the whole body, and then what comes after it."""
    told = False

    async def again() -> Message:
        nonlocal told
        if told:
            return await receive()
        told = True
        return {"type": "http.request", "body": body, "more_body": False}

    return again
