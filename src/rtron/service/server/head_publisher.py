"""Signed heads of the chains go where the database's admin has no hand: files, webhooks, guards."""

import asyncio
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from rtron.service.domain.clock import Clock
from rtron.service.domain.hash_chain import Head
from rtron.service.domain.signed_documents import DocumentSigner
from rtron.service.live.hub import Hub
from rtron.service.server.heads_journal import HeadsJournal
from rtron.service.store.chains import SERVICE_CHAIN, audit_chain, chain_heads, events_chain
from rtron.service.store.database import Database

log = logging.getLogger(__name__)

Heads = Mapping[str, Head]


class HeadPublisher:
    """Publishes what has changed every `interval_s` seconds, and once more at the end."""

    def __init__(
        self,
        database: Database,
        hub: Hub,
        signer: DocumentSigner,
        clock: Clock,
        *,
        journal: HeadsJournal,
        interval_s: float,
        on_heads: Callable[[Mapping[str, Any]], Awaitable[None]],
    ) -> None:
        """`on_heads` is awaited with each document that goes into the journal."""
        self._database, self._hub, self._signer, self._clock = database, hub, signer, clock
        self._journal, self._interval_s, self._on_heads = journal, interval_s, on_heads
        self._published: Heads = {}
        self._sent: dict[str, Heads] = {}

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Publish until the end of the block."""
        task = asyncio.create_task(self._run())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            await self.publish()

    async def publish(self) -> None:
        """Publish what has changed since the last time; what fails is published the next time."""
        try:
            document = await asyncio.to_thread(self._publish)
        except (SQLAlchemyError, OSError) as error:
            log.error("the heads of the audit log are not published: %s", error)  # noqa: TRY400
            return
        if document:
            await self._on_heads(document)

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(self._interval_s)
            await self.publish()

    def _publish(self) -> Mapping[str, Any] | None:
        with self._database.session() as session:
            heads = chain_heads(session)
        now = self._clock()
        self._send_to_guards(heads, now)
        published = {} if self._journal.rotate() else self._published
        changed = {name: head for name, head in heads.items() if published.get(name) != head}
        if not changed:
            return None
        document = self._signer.sign_heads(now, changed)
        self._journal.append(document)
        self._published = heads
        return document

    def _send_to_guards(self, heads: Heads, now: int) -> None:
        """Give each guard the heads of its robot and of the service, if they have changed."""
        connected = self._hub.connected_robots()
        self._sent = {robot: sent for robot, sent in self._sent.items() if robot in connected}
        for robot in connected:
            names = SERVICE_CHAIN, audit_chain(robot), events_chain(robot)
            own = {name: heads[name] for name in names if name in heads}
            if own and self._sent.get(robot) != own:
                self._hub.send_heads(robot, self._signer.sign_heads(now, own))
                self._sent[robot] = own
