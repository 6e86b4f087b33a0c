"""The way of events into the database: one writer for all guards, within a bounded memory.

What arrives while one transaction is committed, and a moment longer, goes into the next one: a
transaction of many robots' events costs little more than that of one. Nobody is told that events
are stored before the commit that has them.

`Stored` speaks of all events of a run up to a number. So once events are refused, because they
cannot be stored now, later ones of that run are refused too, until they come again in order; and of
what was on its way then nothing is confirmed, before it comes again.

the link sends      1 2   3 4   5 6                     3 4 5   6
    the service stores  yes   no    yes, or is not asked    yes     yes
    and answers         2     refused                       5       6
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from rtron.service.store.database import is_unavailable
from rtron.service.store.events import EventBatch, StoredEvent
from rtron.vocabulary import GuardEvent
from rtron.wire.common.link_protocol import EventsRefused, Stored

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


class EventReceipts:
    """The receipts of one connection that are still to be sent."""

    def __init__(self) -> None:
        self._stored: dict[str, int] = {}
        self._refused: dict[str, int] = {}
        self._has_refusal = False
        self._refusals = 0

    def accept(self, events: Sequence[GuardEvent]) -> int | None:
        """Return a number to confirm these events with; None if they leave out refused ones."""
        first = {event.run: event.number for event in reversed(events)}
        if any(number > self._refused.get(run, number) for run, number in first.items()):
            self._note_refused(events)
            return None
        for run in first:
            self._refused.pop(run, None)
        return self._refusals

    def refuse(self, events: Sequence[GuardEvent]) -> None:
        """Note that events are not stored, and have to come again."""
        self._note_refused(events)
        self._refusals += 1
        self._has_refusal = True

    def confirm(self, events: Sequence[GuardEvent], number: int) -> None:
        """Note that events are stored that were accepted with a number."""
        if number == self._refusals:
            for event in events:
                self._stored[event.run] = max(event.number, self._stored.get(event.run, 0))

    def take(self) -> Iterator[Stored | EventsRefused]:
        """Yield what is to be sent now."""
        while self._stored:
            run, number = self._stored.popitem()
            yield Stored(run=run, number=number)
        if self._has_refusal:
            self._has_refusal = False
            yield EventsRefused()

    def _note_refused(self, events: Sequence[GuardEvent]) -> None:
        for event in events:
            self._refused[event.run] = min(event.number, self._refused.get(event.run, event.number))
