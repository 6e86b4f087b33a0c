"""The data collector (paper section 6.3): what guards tell is stored, and what is live is told."""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Protocol

from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.event_writer import EventWriter
from rtron.service.domain.clock import Clock
from rtron.service.domain.plan_json import plan_digest, plan_json
from rtron.service.live.hub import Hub
from rtron.service.store.database import Database
from rtron.service.store.events import (
    EventBatch,
    StoredEvent,
    add_events,
    lost_event_count,
    lost_events_by_robot,
)
from rtron.service.store.retention import RetentionLimits, prune_events
from rtron.service.store.robots import find_robot, register_robot
from rtron.service.store.settings import load_settings, newest_settings
from rtron.vocabulary import EventKind, GuardEventLevel, Settings
from rtron.wire.common.link_protocol import Applied, Hello


@dataclass(slots=True)
class CollectorCounters:
    """Counts of the collector's work since the service started.

    `protocol_violations` are connections that sent something else than the link's messages,
    `slow_connections` connections that were too slow. `duplicate_events` are events that were
    already stored. The events took `transactions` transactions in `transaction_seconds` (s);
    `failed_batches` could not be stored, `pruned_events` were deleted by the retention.
    """

    connections: int = 0
    unauthorised_connections: int = 0
    replaced_connections: int = 0
    protocol_violations: int = 0
    slow_connections: int = 0
    stored_events: int = 0
    duplicate_events: int = 0
    transactions: int = 0
    transaction_seconds: float = 0.0
    failed_batches: int = 0
    pruned_events: int = 0


class HandshakeHandler(Protocol):
    """Both are called in threads, never in the event loop; they may be called again alike."""

    def handle_hello(self, robot: str, hello: Hello) -> Settings:
        """Keep the robot's app, plan and coordination nodes; return the settings to put in force.

        RTronError refuses the guard; its text is told.
        """

    def handle_applied(self, robot: str, applied: Applied) -> None:
        """Note that the guard has put settings in force, or why it has not."""


log = logging.getLogger(__name__)

Authenticate = Callable[[str], str | None]
"""Returns the robot that a token speaks for, or None; called in a thread."""

MAX_LIVE_EVENTS = 200
"""So many events of one transaction are told live, those of the highest level first."""
_RETENTION_INTERVAL_S = 60.0
_PAUSE_S = 0.01
_LEVELS = tuple(GuardEventLevel)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConnectionTimeouts:
    """How long a guard may take, s: to say hello, between two messages, to read one.

    After `token` seconds, again and again, it is asked whether the token still holds.
    """

    hello: float = 10.0
    silence: float = 30.0
    sending: float = 10.0
    token: float = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DataCollector:
    """What all connections of guards share; it works while it is `running`."""

    database: Database
    hub: Hub
    handshake: HandshakeHandler
    authenticate: Authenticate
    clock: Clock
    retention: RetentionLimits
    timeouts: ConnectionTimeouts = field(default_factory=ConnectionTimeouts)
    counters: CollectorCounters = field(default_factory=CollectorCounters)
    event_writer: EventWriter = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "event_writer", EventWriter(self._store_batches, self._note_stored)
        )

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Store and forget events until the end of the block."""
        await asyncio.to_thread(self._load_lost_events)
        tasks = [
            asyncio.create_task(each) for each in (self.event_writer.run(), self._run_retention())
        ]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    def handle_hello(self, robot: str, hello: Hello) -> Settings:
        """Return what to put in force; if nothing can be stored, the newest that is known."""
        try:
            return self.handshake.handle_hello(robot, hello)
        except SQLAlchemyError as error:
            log.error("%s is greeted, which is not stored: %s", robot, type(error).__name__)  # noqa: TRY400
        candidates = (
            hello.settings,
            self._newest_settings(robot, hello),
            self.hub.last_pushed_settings(robot),
        )
        return max(candidates, key=lambda settings: settings.revision)

    def _newest_settings(self, robot: str, hello: Hello) -> Settings:
        """Return the newest settings of a guard's app, if they were made for its plan."""
        with self.database.session() as session:
            _, app = find_robot(session, robot) or (None, None)
            if app is None or app.name != hello.app:
                return Settings()
            row = newest_settings(session, app.id)
            is_same = app.digest == plan_digest(plan_json(hello.plan))
            return load_settings(row) if row and is_same else Settings()

    def handle_applied(self, robot: str, applied: Applied) -> None:
        """Hand on what a guard answers; if that cannot be stored, it goes on all the same."""
        try:
            self.handshake.handle_applied(robot, applied)
        except SQLAlchemyError as error:
            log.error("%s has answered, which is not stored: %s", robot, type(error).__name__)  # noqa: TRY400

    def register_robot(self, robot: str) -> int | None:
        """Return the robot's id, and note that it was seen now; None if it can be neither."""
        try:
            with self.database.write_session() as session:
                return register_robot(session, robot, self.clock()).id
        except SQLAlchemyError as error:
            log.warning("%s is connected, which is not noted: %s", robot, type(error).__name__)
        with self.database.session() as session:
            match = find_robot(session, robot)
        return match[0].id if match else None

    def _store_batches(self, batches: Sequence[EventBatch]) -> Sequence[StoredEvent]:
        start = time.perf_counter()
        with self.database.write_session() as session:
            added = add_events(session, self.clock(), batches)
        self.counters.transactions += 1
        self.counters.transaction_seconds += time.perf_counter() - start
        return added

    def _note_stored(self, added: Sequence[StoredEvent], events: int) -> None:
        self.counters.stored_events += len(added)
        self.counters.duplicate_events += events - len(added)
        for each in added:
            if each.row["kind"] == EventKind.LOST:
                self.hub.add_lost_events(each.robot, lost_event_count(each.row["values"]))
        if self.hub.has_listeners:
            self._broadcast(added)

    def _broadcast(self, added: Sequence[StoredEvent]) -> None:
        selected = added
        if len(added) > MAX_LIVE_EVENTS:
            by_level = sorted(added, key=lambda each: _LEVELS.index(each.row["level"]))
            selected = sorted(by_level[-MAX_LIVE_EVENTS:], key=lambda each: int(each.row["id"]))
        for each in selected:
            self.hub.broadcast({"type": "event", "event": each.view().model_dump(mode="json")})

    def _load_lost_events(self) -> None:
        with self.database.session() as session:
            for robot, events in lost_events_by_robot(session).items():
                self.hub.add_lost_events(robot, events)

    async def _run_retention(self) -> None:
        while True:
            try:
                await self._prune_events()
            except SQLAlchemyError as error:
                log.error("old events are not deleted: %s", type(error).__name__)  # noqa: TRY400
            await asyncio.sleep(_RETENTION_INTERVAL_S)

    async def _prune_events(self) -> None:
        slices = prune_events(self.database, self.retention, self.clock())
        while (deleted := await asyncio.to_thread(next, slices, None)) is not None:
            self.counters.pruned_events += deleted
            await asyncio.sleep(_PAUSE_S)
