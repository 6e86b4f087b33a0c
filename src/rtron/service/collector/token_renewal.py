"""Guards get a new token before theirs is over, on the connection that they have."""

import asyncio
import logging
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress

from anyio import move_on_after
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.domain.errors import ConflictError
from rtron.service.store.accounts.tokens import GuardTokens

log = logging.getLogger(__name__)

_MAX_AT_A_TIME = 20
"""So a fleet whose tokens were made on one day renews them one after the other."""
_RETRY_AFTER_S = 3600.0


class TokenRenewal:
    """Offers new tokens to the guards that take them, while it runs; used in the event loop."""

    def __init__(self, tokens: GuardTokens, interval_s: float) -> None:
        self._tokens = tokens
        self._interval_s = interval_s
        self._connections: dict[object, tuple[str, Callable[[str], None]]] = {}
        self._offered: dict[object, float] = {}

    def add(self, connection: object, token: str, offer: Callable[[str], None]) -> None:
        """Call `offer` with the next secret of a connection's token, when it is time."""
        self._connections[connection] = token, offer

    def remove(self, connection: object) -> None:
        """Offer a connection nothing more."""
        self._connections.pop(connection, None)
        self._offered.pop(connection, None)

    async def promote(self, secret: str) -> None:
        """Let a next secret replace the one before: the guard has it on disk."""
        await asyncio.to_thread(self._tokens.promote, secret)

    async def run(self) -> None:
        """Look for tokens that are soon over, until it is cancelled."""
        while True:
            try:
                await self._renew_due()
            except SQLAlchemyError as error:
                log.warning("tokens are renewed later: %s", type(error).__name__)
            await asyncio.sleep(self._interval_s)

    async def _renew_due(self) -> None:
        waiting = self._not_offered_lately()
        if not waiting:
            return
        secrets = {token for token, _ in waiting.values()}
        due = await asyncio.to_thread(self._tokens.find_due, secrets)
        chosen = [each for each, (token, _) in waiting.items() if token in due]
        for connection in chosen[:_MAX_AT_A_TIME]:
            await self._renew(connection, *waiting[connection])

    def _not_offered_lately(self) -> Mapping[object, tuple[str, Callable[[str], None]]]:
        """Return the connections whose guard has not just failed to keep a new token."""
        since = asyncio.get_running_loop().time() - _RETRY_AFTER_S
        return {
            connection: entry
            for connection, entry in self._connections.items()
            if self._offered.get(connection, since) <= since
        }

    async def _renew(self, connection: object, token: str, offer: Callable[[str], None]) -> None:
        try:
            renewed = await asyncio.to_thread(self._tokens.renew, token)
        except ConflictError as error:
            log.info("a guard's token is renewed later: %s", error)
            return
        if renewed is not None and connection in self._connections:
            self._offered[connection] = asyncio.get_running_loop().time()
            offer(renewed)


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
