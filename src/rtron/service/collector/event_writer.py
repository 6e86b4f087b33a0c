"""The way of events into the database: one writer for all guards, within a bounded memory.

What arrives while one transaction is committed, and a moment longer, goes into the next one: a
transaction of many robots' events costs little more than that of one. Nobody is told that events
are stored before the commit that has them.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from rtron.service.store.database import is_unavailable
from rtron.service.store.events import EventBatch, StoredEvent

log = logging.getLogger(__name__)

MAX_QUEUED_BYTES = 8 << 20
"""So many bytes of messages wait to be stored; whoever has more to say has to wait."""
MIN_INTERVAL_S = 0.05
"""So long after the beginning of a transaction begins the next one, unless a full one waits, s."""
MAX_TRANSACTION_EVENTS = 1000
"""A transaction ends with the batch that reaches so many events."""

StoreBatches = Callable[[Sequence[EventBatch]], Sequence[StoredEvent]]
"""Stores batches in one transaction, in a thread; raises if none of them is stored."""


@dataclass(frozen=True, slots=True)
class QueuedBatch:
    """A batch, the bytes it came in, and who is told what came of it."""

    batch: EventBatch
    size: int
    on_stored: Callable[[bool], None]


class EventWriter:
    """Takes batches of all guards; `run` stores them."""

    def __init__(
        self,
        store: StoreBatches,
        on_stored: Callable[[Sequence[StoredEvent], int], None],
        thread: Executor | None = None,
    ) -> None:
        """Store with `store` in `thread`, or any; `on_stored` is told what was new, of how many."""
        self._thread = thread
        self._store = store
        self._on_stored = on_stored
        self._queue: deque[QueuedBatch] = deque()
        self._size = 0
        self._has_batches = asyncio.Event()
        self._space_freed = asyncio.Condition()

    async def put(self, queued: QueuedBatch) -> None:
        """Add a batch, once there is place for it; what is larger than all place comes alone."""
        async with self._space_freed:
            await self._space_freed.wait_for(lambda: not self._size or self._fits(queued))
            self._size += queued.size
        self._queue.append(queued)
        self._has_batches.set()

    async def run(self) -> None:
        """Store what comes, until it is cancelled."""
        loop = asyncio.get_running_loop()
        while True:
            await self._has_batches.wait()
            begin, group = loop.time(), self._next_transaction()
            await self._write(group)
            async with self._space_freed:
                self._size -= sum(each.size for each in group)
                self._space_freed.notify_all()
            if not self._is_full:
                await asyncio.sleep(begin + MIN_INTERVAL_S - loop.time())

    @property
    def _is_full(self) -> bool:
        """Whether more waits than can be left for a moment."""
        return self._size > MAX_QUEUED_BYTES // 8

    def _fits(self, queued: QueuedBatch) -> bool:
        return self._size + queued.size <= MAX_QUEUED_BYTES

    def _next_transaction(self) -> list[QueuedBatch]:
        """Take what one transaction is to have."""
        group: list[QueuedBatch] = []
        events = 0
        while self._queue and events < MAX_TRANSACTION_EVENTS:
            group.append(self._queue.popleft())
            events += len(group[-1].batch.events)
        if not self._queue:
            self._has_batches.clear()
        return group

    async def _write(self, group: Sequence[QueuedBatch]) -> None:
        """Store a group; if that fails, each batch by itself: one must not harm the others.

        If the database is the reason, it is tried for none of them.
        """
        error = await self._try_store(group)
        if error is None:
            return
        if len(group) == 1 or is_unavailable(error):
            for queued in group:
                queued.on_stored(False)  # noqa: FBT003 - it is the answer
            return
        for queued in group:
            await self._write([queued])

    async def _try_store(self, group: Sequence[QueuedBatch]) -> Exception | None:
        """Store a group; return why it is not stored."""
        batches = [queued.batch for queued in group]
        try:
            storing = asyncio.get_running_loop().run_in_executor(self._thread, self._store, batches)
            added = await storing
        except Exception as error:  # noqa: BLE001 - whatever it is, the other guards' events go on
            log.error("%d batches of events are not stored: %s", len(group), type(error).__name__)  # noqa: TRY400
            return error
        self._on_stored(added, sum(len(batch.events) for batch in batches))
        for queued in group:
            queued.on_stored(True)  # noqa: FBT003 - it is the answer
        return None
