"""The way of events into the database: one writer for all guards, within a bounded memory.

What arrives while one transaction is committed goes into the next one. Nobody is told that events
are stored before the commit that has them.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rtron.service.store.events import Added, Batch

log = logging.getLogger(__name__)

MOST_BYTES = 8 << 20
"""So many bytes of messages wait to be stored; whoever has more to say has to wait."""
MOST_EVENTS = 1000
"""A transaction ends with the batch that reaches so many events."""

Store = Callable[[Sequence[Batch]], Sequence[Added]]
"""Stores batches in one transaction, in a thread; raises if none of them is stored."""


@dataclass(frozen=True, slots=True)
class Waiting:
    """A batch, the bytes it came in, and who is told what came of it."""

    batch: Batch
    size: int
    done: Callable[[bool], None]


class Intake:
    """Takes batches of all guards; `run` stores them."""

    def __init__(self, store: Store, stored: Callable[[Sequence[Added], int], None]) -> None:
        """Store with `store`; `stored` is told what was new, and how many events came."""
        self._store = store
        self._stored = stored
        self._waiting: deque[Waiting] = deque()
        self._size = 0
        self._more = asyncio.Event()
        self._less = asyncio.Condition()

    async def put(self, waiting: Waiting) -> None:
        """Add a batch, once there is place for it; what is larger than all place comes alone."""
        async with self._less:
            await self._less.wait_for(lambda: not self._size or self._fits(waiting))
            self._size += waiting.size
        self._waiting.append(waiting)
        self._more.set()

    async def run(self) -> None:
        """Store what comes, until it is cancelled."""
        while True:
            await self._more.wait()
            group = self._group()
            await self._write(group)
            async with self._less:
                self._size -= sum(each.size for each in group)
                self._less.notify_all()

    def _fits(self, waiting: Waiting) -> bool:
        return self._size + waiting.size <= MOST_BYTES

    def _group(self) -> list[Waiting]:
        """Take what one transaction is to have."""
        group: list[Waiting] = []
        events = 0
        while self._waiting and events < MOST_EVENTS:
            group.append(self._waiting.popleft())
            events += len(group[-1].batch.events)
        if not self._waiting:
            self._more.clear()
        return group

    async def _write(self, group: Sequence[Waiting]) -> None:
        """Store a group; if that fails, each batch by itself: one must not harm the others."""
        if await self._try(group):
            return
        if len(group) == 1:
            group[0].done(False)  # noqa: FBT003 - it is the answer
            return
        for waiting in group:
            await self._write([waiting])

    async def _try(self, group: Sequence[Waiting]) -> bool:
        batches = [waiting.batch for waiting in group]
        try:
            added = await asyncio.to_thread(self._store, batches)
        except Exception as error:  # noqa: BLE001 - whatever it is, the other guards' events go on
            log.error("%d batches of events are not stored: %s", len(group), type(error).__name__)  # noqa: TRY400
            return False
        self._stored(added, sum(len(batch.events) for batch in batches))
        for waiting in group:
            waiting.done(True)  # noqa: FBT003 - it is the answer
        return True
