"""One webhook at work: alerts wait in a bounded queue and are sent one after the other."""

import json
import logging
from asyncio import Queue, QueueFull
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import httpx
from anyio import sleep, to_thread
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.alerts.webhook_call import WebhookCall, WebhookCallError, send_call
from rtron.service.domain.clock import Clock
from rtron.service.domain.schemas import WebhookLevel
from rtron.service.store.tables import WebhookRow
from rtron.vocabulary import GuardEventLevel

log = logging.getLogger(__name__)

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
