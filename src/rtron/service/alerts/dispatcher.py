"""Alerts: what guards and roll-outs report and people must see, sent to the webhooks."""

import asyncio
import json
import logging
from asyncio import Queue, QueueFull
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from typing import Any

import httpx
from anyio import sleep, to_thread
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.alerts.webhook_call import WebhookCall, WebhookCallError, new_client, send_call
from rtron.service.domain.clock import Clock
from rtron.service.domain.rollouts.observations import ROLLOUT, alert_event
from rtron.service.domain.schemas import WebhookLevel
from rtron.service.live.hub import Hub
from rtron.service.store.database import Database
from rtron.service.store.tables import WebhookRow
from rtron.service.store.webhooks import all_webhooks, store_failure
from rtron.vocabulary import GuardEventLevel

RETRY_DELAYS_S = (1.0, 4.0, 16.0)
"""How long to wait before an alert is sent again, s."""
_MAX_QUEUED = 200
_SECOND = 1_000_000_000
_LEVEL_ORDER = tuple(map(str, GuardEventLevel))


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerContext:
    """What all webhooks share: the connections, the time, and where failures are noted."""

    client: httpx.AsyncClient
    clock: Clock
    store_failure: Callable[[int, str], None]


class WebhookWorker:
    """Sends one webhook what it asks for."""

    def __init__(self, row: WebhookRow, context: WorkerContext) -> None:
        self.row = row
        self._context = context
        self._queue: Queue[Mapping[str, Any]] = Queue(_MAX_QUEUED)
        self._failing = row.failing
        self.dropped = 0

    @property
    def takes_heads(self) -> bool:
        """Whether the webhook takes the heads of the audit log, and no events."""
        return self.row.level == WebhookLevel.HEADS

    def accepts(self, event: Mapping[str, Any]) -> bool:
        """Tell whether an event is bad enough for the webhook."""
        if self.takes_heads:
            return False
        return _LEVEL_ORDER.index(event["level"]) >= _LEVEL_ORDER.index(self.row.level)

    def enqueue(self, message: Mapping[str, Any]) -> None:
        """Let an event, or signed heads, wait; without place they are dropped and counted."""
        try:
            self._queue.put_nowait(message)
        except QueueFull:
            self.dropped += 1

    async def run(self) -> None:
        """Send what waits, for ever."""
        while True:
            message = await self._queue.get()
            reason = await self._deliver(message)
            if reason != self._failing:
                await self._store_outcome(reason)

    async def _store_outcome(self, reason: str) -> None:
        """Note why the last call failed; if that fails, with the next alert."""
        try:
            await to_thread.run_sync(self._context.store_failure, self.row.id, reason)
        except SQLAlchemyError as error:
            log.warning("webhook %s: %s is not noted", self.row.id, type(error).__name__)
        else:
            self._failing = reason

    async def _deliver(self, message: Mapping[str, Any]) -> str:
        """Send a message, again and again within bounds; return why it was given up, or ""."""
        reason = ""
        for pause in (0.0, *RETRY_DELAYS_S):
            await sleep(pause)
            dropped = self.dropped
            try:
                await send_call(
                    self._context.client, self._webhook_call(message), self._timestamp()
                )
            except WebhookCallError as error:
                reason = str(error)
            else:
                self.dropped -= dropped
                return ""
        log.warning("webhook %s: %s", self.row.id, reason)
        self.dropped += 1
        return reason

    def _webhook_call(self, message: Mapping[str, Any]) -> WebhookCall:
        alert = {"schema": "rtron.alert/1", "dropped": self.dropped, "event": message}
        body = json.dumps(message if self.takes_heads else alert).encode()
        return WebhookCall(url=self.row.url, secret=self.row.secret, body=body)

    def _timestamp(self) -> int:
        return self._context.clock() // _SECOND


_MAX_ALARMS = 10_000
_DUPLICATE_WINDOW = 60 * _SECOND
_KEY = ("robot", "kind", "level", "node", "topic", "flow", "publisher", "decision")


class DuplicateFilter:
    """Tells events that were told of late; bounded, time passed in."""

    def __init__(self) -> None:
        self._reported_at: OrderedDict[tuple[Any, ...], int] = OrderedDict()

    def is_duplicate(self, event: Mapping[str, Any], now: int) -> bool:
        """Tell whether an event like this was told of late; if not, it is told now."""
        key = tuple(event.get(name) for name in _KEY)
        reported_at = self._reported_at.get(key)
        if reported_at is not None and now - reported_at < _DUPLICATE_WINDOW:
            return True
        self._reported_at[key] = now
        self._reported_at.move_to_end(key)
        if len(self._reported_at) > _MAX_ALARMS:
            self._reported_at.popitem(last=False)
        return False


log = logging.getLogger(__name__)

_REFRESH_NS = 1_000_000_000


class AlertDispatcher:
    """Listens to the hub and keeps a worker for each webhook."""

    def __init__(self, database: Database, hub: Hub, clock: Clock, monotonic: Clock) -> None:
        """Date calls by `clock`, and wait by `monotonic`."""
        self._database, self._hub = database, hub
        self._clock, self._monotonic = clock, monotonic
        self._duplicates = DuplicateFilter()
        # By their secrets: SQLite gives the id of a removed webhook away again.
        self._workers: dict[str, tuple[WebhookWorker, asyncio.Task[None]]] = {}
        self._refreshed_at: int | None = None
        self._refreshing = asyncio.Lock()
        self._context: WorkerContext | None = None

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Send alerts until the end of the block."""
        task = asyncio.create_task(self._run())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    async def send_heads(self, document: Mapping[str, Any]) -> None:
        """Send signed heads of the audit log to the webhooks that take them."""
        if self._context:
            await self._try_refresh(self._context)
        for worker, _ in self._workers.values():
            if worker.takes_heads:
                worker.enqueue(document)

    async def _run(self) -> None:
        """Listen for ever; one who has listened too slowly begins again."""
        async with new_client() as client:
            context = WorkerContext(
                client=client, clock=self._clock, store_failure=self._store_failure
            )
            self._context = context
            try:
                while True:
                    await self._listen(context)
            finally:
                self._context = None
                await self._stop_workers(set(self._workers))

    async def _listen(self, context: WorkerContext) -> None:
        with self._hub.listen(states=False) as listener:
            async for live in listener:
                if live["type"] == "event":
                    await self._dispatch(live["event"], context)
                elif live["type"] == ROLLOUT and live["alert"]:
                    await self._dispatch(alert_event(live, self._clock()), context)

    async def _dispatch(self, event: Mapping[str, Any], context: WorkerContext) -> None:
        now = self._monotonic()
        if self._refreshed_at is None or now - self._refreshed_at >= _REFRESH_NS:
            self._refreshed_at = now
            await self._try_refresh(context)
        accepting = [worker for worker, _ in self._workers.values() if worker.accepts(event)]
        if accepting and not self._duplicates.is_duplicate(event, now):
            for worker in accepting:
                worker.enqueue(event)

    async def _try_refresh(self, context: WorkerContext) -> None:
        """Look which webhooks there are; if that fails, those of before go on."""
        try:
            async with self._refreshing:
                await self._refresh(context)
        except SQLAlchemyError as error:
            log.error("webhooks cannot be looked up: %s", type(error).__name__)  # noqa: TRY400

    async def _refresh(self, context: WorkerContext) -> None:
        rows = {row.secret: row for row in await to_thread.run_sync(self._load_webhooks)}
        await self._stop_workers(self._workers.keys() - rows.keys())
        for secret in rows.keys() - self._workers.keys():
            worker = WebhookWorker(rows[secret], context)
            self._workers[secret] = worker, asyncio.create_task(worker.run())

    async def _stop_workers(self, secrets: set[str]) -> None:
        for secret in secrets:
            _, task = self._workers.pop(secret)
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task

    def _load_webhooks(self) -> list[WebhookRow]:
        with self._database.session() as session:
            return list(all_webhooks(session))

    def _store_failure(self, id: int, reason: str) -> None:
        with self._database.session() as session:
            store_failure(session, id, reason)
