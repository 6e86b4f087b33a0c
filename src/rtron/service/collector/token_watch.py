"""Connections of guards end with their tokens: looked up together, and at once on a revocation."""

import asyncio
from collections.abc import Callable, Collection
from contextlib import suppress

from anyio import move_on_after
from sqlalchemy.exc import SQLAlchemyError

FindValidTokens = Callable[[Collection[str]], Collection[str]]
"""Returns those of the tokens that still hold; called in a thread."""


class TokenWatch:
    """Watches the tokens of all connections while it runs; used in the event loop."""

    def __init__(self, find_valid: FindValidTokens, interval_s: float) -> None:
        self._find_valid = find_valid
        self._interval_s = interval_s
        self._connections: dict[object, tuple[str, Callable[[], None]]] = {}
        self._is_due = asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    def add(self, connection: object, token: str, end: Callable[[], None]) -> None:
        """Call `end` once the token of a connection no longer holds."""
        self._connections[connection] = token, end

    def remove(self, connection: object) -> None:
        """Watch the token of a connection no more."""
        self._connections.pop(connection, None)

    def recheck(self) -> None:
        """Look all tokens up now: one is revoked; from any thread."""
        if self._loop:
            with suppress(RuntimeError):  # the service has ended
                self._loop.call_soon_threadsafe(self._is_due.set)

    async def run(self) -> None:
        """Look the tokens up until it is cancelled: a token ends, or another process revokes it."""
        self._loop = asyncio.get_running_loop()
        while True:
            with move_on_after(self._interval_s):
                await self._is_due.wait()
            self._is_due.clear()
            with suppress(SQLAlchemyError):  # it is away: no reason to leave a guard alone
                await self._check()

    async def _check(self) -> None:
        watched = dict(self._connections)
        tokens = {token for token, _ in watched.values()}
        if not tokens:
            return
        valid = await asyncio.to_thread(self._find_valid, tokens)
        for connection, (token, end) in watched.items():
            if token not in valid and self._connections.get(connection) == (token, end):
                end()
