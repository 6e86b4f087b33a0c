"""Whose password is checked next: who failed least, so that guessers keep nobody out."""

import asyncio
from bisect import insort
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from itertools import count

from rtron.service.domain.errors import TooManyRequestsError

CONCURRENT_LOGINS = 2
"""Each check takes 64 MiB and a core."""
MAX_WAITING = 64
"""With one more the last in the queue is turned away."""


@dataclass(order=True, slots=True)
class _Waiting:
    rank: int
    number: int
    turn: "asyncio.Future[None]" = field(compare=False)


class LoginQueue:
    """Lets few in at a time, those of the lowest rank first; used in the event loop."""

    def __init__(self) -> None:
        self._free = CONCURRENT_LOGINS
        self._waiting: list[_Waiting] = []
        self._numbers = count()

    @asynccontextmanager
    async def turn(self, rank: int) -> AsyncIterator[None]:
        """Wait for a turn, which ends with the block; TooManyRequestsError if too many wait."""
        await self._enter(rank)
        try:
            yield
        finally:
            self._leave()

    async def _enter(self, rank: int) -> None:
        if self._free:
            self._free -= 1
            return
        turn = asyncio.get_running_loop().create_future()
        waiting = _Waiting(rank, next(self._numbers), turn)
        insort(self._waiting, waiting)
        if len(self._waiting) > MAX_WAITING:
            error = TooManyRequestsError("too many logins at this moment", help="try again soon")
            self._waiting.pop().turn.set_exception(error)
        try:
            await turn
        except asyncio.CancelledError:
            if waiting in self._waiting:
                self._waiting.remove(waiting)
            elif not turn.cancelled() and turn.exception() is None:
                self._leave()
            raise

    def _leave(self) -> None:
        while self._waiting:
            turn = self._waiting.pop(0).turn
            if not turn.done():
                turn.set_result(None)
                return
        self._free += 1
