"""Alerts: what the guards report and people must see, sent to the webhooks."""

import asyncio
import logging
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress
from typing import Any

from anyio import to_thread
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.alerts.repeats import Repeats
from rtron.service.alerts.webhook_call import new_client
from rtron.service.alerts.worker import Habits, Worker
from rtron.service.domain.clock import Clock
from rtron.service.live.hub import Hub
from rtron.service.store.database import Database
from rtron.service.store.tables import WebhookRow
from rtron.service.store.webhooks import all_webhooks, note_failing

log = logging.getLogger(__name__)

_REFRESH = 1_000_000_000


class Alerts:
    """Listens to the hub and keeps a worker for each webhook."""

    def __init__(self, database: Database, hub: Hub, clock: Clock) -> None:
        self._database, self._hub, self._clock = database, hub, clock
        self._repeats = Repeats()
        self._workers: dict[int, tuple[Worker, asyncio.Task[None]]] = {}
        self._looked: int | None = None

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Send alerts until the end of the block."""
        task = asyncio.create_task(self._run())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    async def _run(self) -> None:
        """Listen for ever; one who has listened too slowly begins again."""
        async with new_client() as client:
            habits = Habits(client=client, clock=self._clock, note=self._note)
            try:
                while True:
                    await self._listen(habits)
            finally:
                await self._end(set(self._workers))

    async def _listen(self, habits: Habits) -> None:
        with self._hub.listen() as listener:
            async for live in listener:
                if live["type"] == "event":
                    await self._take(live["event"], habits)

    async def _take(self, event: Mapping[str, Any], habits: Habits) -> None:
        now = self._clock()
        if self._looked is None or now - self._looked >= _REFRESH:
            self._looked = now
            await self._try_refresh(habits)
        wanted = [worker for worker, _ in self._workers.values() if worker.wants(event)]
        if wanted and not self._repeats.is_one(event, now):
            for worker in wanted:
                worker.take(event)

    async def _try_refresh(self, habits: Habits) -> None:
        """Look which webhooks there are; if that fails, those of before go on."""
        try:
            await self._refresh(habits)
        except SQLAlchemyError as error:
            log.error("webhooks cannot be looked up: %s", type(error).__name__)  # noqa: TRY400

    async def _refresh(self, habits: Habits) -> None:
        rows = {row.id: row for row in await to_thread.run_sync(self._rows)}
        await self._end(self._workers.keys() - rows.keys())
        for id in rows.keys() - self._workers.keys():
            worker = Worker(rows[id], habits)
            self._workers[id] = worker, asyncio.create_task(worker.run())

    async def _end(self, ids: set[int]) -> None:
        for id in ids:
            _, task = self._workers.pop(id)
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task

    def _rows(self) -> list[WebhookRow]:
        with self._database.session() as session:
            return list(all_webhooks(session))

    def _note(self, id: int, why: str) -> None:
        with self._database.session() as session:
            note_failing(session, id, why)
