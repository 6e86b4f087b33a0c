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

from rtron.service.alerts.webhook_call import CallError, Letter, post
from rtron.service.domain.clock import Clock
from rtron.service.store.tables import WebhookRow
from rtron.vocabulary import Level

log = logging.getLogger(__name__)

PAUSES = (1.0, 4.0, 16.0)
"""How long to wait before an alert is sent again, s."""
_MOST_WAITING = 200
_SECOND = 1_000_000_000
_ORDER = tuple(map(str, Level))


@dataclass(frozen=True, slots=True, kw_only=True)
class Habits:
    """What all webhooks share: the connections, the time, and where failures are noted."""

    client: httpx.AsyncClient
    clock: Clock
    note: Callable[[int, str], None]


class Worker:
    """Sends one webhook what it asks for."""

    def __init__(self, row: WebhookRow, habits: Habits) -> None:
        self.row = row
        self._habits = habits
        self._waiting: Queue[Mapping[str, Any]] = Queue(_MOST_WAITING)
        self._failing = row.failing
        self.dropped = 0

    def wants(self, event: Mapping[str, Any]) -> bool:
        """Tell whether an event is bad enough for the webhook."""
        return _ORDER.index(event["level"]) >= _ORDER.index(self.row.level)

    def take(self, event: Mapping[str, Any]) -> None:
        """Let an event wait; without place it is dropped and counted."""
        try:
            self._waiting.put_nowait(event)
        except QueueFull:
            self.dropped += 1

    async def run(self) -> None:
        """Send what waits, for ever."""
        while True:
            event = await self._waiting.get()
            why = await self._sent(event)
            if why != self._failing:
                await self._note(why)

    async def _note(self, why: str) -> None:
        """Note why the last call failed; if that fails, with the next alert."""
        try:
            await to_thread.run_sync(self._habits.note, self.row.id, why)
        except SQLAlchemyError as error:
            log.warning("webhook %s: %s is not noted", self.row.id, type(error).__name__)
        else:
            self._failing = why

    async def _sent(self, event: Mapping[str, Any]) -> str:
        """Send an alert, again and again within bounds; return why it was given up, or ""."""
        why = ""
        for pause in (0.0, *PAUSES):
            await sleep(pause)
            dropped = self.dropped
            try:
                await post(self._habits.client, self._letter(event), self._now())
            except CallError as error:
                why = str(error)
            else:
                self.dropped -= dropped
                return ""
        log.warning("webhook %s: %s", self.row.id, why)
        self.dropped += 1
        return why

    def _letter(self, event: Mapping[str, Any]) -> Letter:
        said = {"schema": "rtron.alert/1", "dropped": self.dropped, "event": event}
        body = json.dumps(said).encode()
        return Letter(url=self.row.url, secret=self.row.secret, body=body)

    def _now(self) -> int:
        return self._habits.clock() // _SECOND
