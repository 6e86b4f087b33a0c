"""The data collector (paper section 6.3): what guards tell is stored, and what is live is told."""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Protocol

from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.event_retention import EventRetention
from rtron.service.collector.event_writer import EventWriter
from rtron.service.collector.guard_certificates import GuardCertificates
from rtron.service.collector.heads_check import HeadsCheck
from rtron.service.collector.token_renewal import FindValidTokens, TokenRenewal, TokenWatch
from rtron.service.domain.alarms import acknowledged_change
from rtron.service.domain.clock import Clock, SteadyClock
from rtron.service.domain.hash_chain import DocumentSigner
from rtron.service.domain.plan_json import plan_digest, plan_json
from rtron.service.domain.schemas import EventView
from rtron.service.live.hub import Hub
from rtron.service.live.listener import LiveMessage
from rtron.service.store.database import Database
from rtron.service.store.events import (
    EventBatch,
    StoredEvent,
    add_events,
    lost_event_count,
    lost_events_by_robot,
)
from rtron.service.store.fleet.rollouts import find_plan_document
from rtron.service.store.incidents import INCIDENT_MESSAGE, add_incident
from rtron.service.store.notices import EventsNotice, post_notice
from rtron.service.store.retention import RetentionLimits
from rtron.service.store.robots import find_robot, register_robot
from rtron.service.store.settings import load_settings, newest_settings
from rtron.service.store.shifts import end_acknowledgements
from rtron.vocabulary import EventKind, GuardEventLevel, Settings
from rtron.wire.common.incident_report import IncidentReport
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
_LEVELS = tuple(GuardEventLevel)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConnectionTimeouts:
    """How long a guard may take, s: to say hello, between two messages, to read one.

    After `token` seconds, again and again, all tokens are looked up: those of `rtron token revoke`
    and those that are over end then. What the API revokes ends at once.
    """

    hello: float = 10.0
    silence: float = 30.0
    sending: float = 10.0
    token: float = 5.0


class CollectorThreads:
    """Threads for each kind of work of guards: a crowd of one kind holds up no other, nor people.

    `tokens` are looked up, `handshakes` are hellos, `answers` what guards say to settings, `events`
    are stored, `heads` are compared, `incidents` are stored as well.
    """

    def __init__(self) -> None:
        self.tokens = ThreadPoolExecutor(1, "tokens")
        self.handshakes = ThreadPoolExecutor(2, "handshakes")
        self.answers = ThreadPoolExecutor(1, "answers")
        self.events = ThreadPoolExecutor(1, "events")
        self.heads = ThreadPoolExecutor(1, "heads")
        self.incidents = ThreadPoolExecutor(1, "incidents")

    def close(self) -> None:
        """End when what was begun is done."""
        for each in vars(self).values():
            each.shutdown(wait=False, cancel_futures=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class DataCollector:
    """What all connections of guards share; it works while it is `running`."""

    database: Database
    hub: Hub
    handshake: HandshakeHandler
    authenticate: Authenticate
    find_valid_tokens: FindValidTokens
    clock: Clock
    steady_clock: SteadyClock
    retention: RetentionLimits
    signer: DocumentSigner
    token_renewal: TokenRenewal | None = None
    certificates: GuardCertificates | None = None
    timeouts: ConnectionTimeouts = field(default_factory=ConnectionTimeouts)
    counters: CollectorCounters = field(default_factory=CollectorCounters)
    threads: CollectorThreads = field(default_factory=CollectorThreads)
    heads_check: HeadsCheck = field(init=False)
    event_writer: EventWriter = field(init=False)
    token_watch: TokenWatch = field(init=False)
    event_retention: EventRetention = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(
            self,
            "event_writer",
            EventWriter(self._store_batches, self._note_stored, self.threads.events),
        )
        heads_check = HeadsCheck(self.database, self.signer, self.clock)
        object.__setattr__(self, "heads_check", heads_check)
        watch = TokenWatch(self.find_valid_tokens, self.timeouts.token)
        object.__setattr__(self, "token_watch", watch)
        retention = EventRetention(
            self.database,
            self.retention,
            self.signer,
            self.clock,
            event_writer=self.event_writer,
            on_deleted=self._count_pruned,
        )
        object.__setattr__(self, "event_retention", retention)

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Store and forget events until the end of the block."""
        await asyncio.to_thread(self._load_lost_events)
        works = [self.event_writer.run(), self.token_watch.run(), self.event_retention.run()]
        if self.token_renewal:
            works.append(self.token_renewal.run())
        tasks = [asyncio.create_task(each) for each in works]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self.threads.close()

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
        """Return the robot's id, made if the hello could not be stored; None if it cannot be."""
        try:
            with self.database.session() as session:
                match = find_robot(session, robot)
            if match:
                return match[0].id
            with self.database.write_session() as session:
                return register_robot(session, robot, self.clock()).id
        except SQLAlchemyError as error:
            log.warning("%s is connected, which is not noted: %s", robot, type(error).__name__)
            return None

    def store_incident(self, robot_id: int, report: IncidentReport) -> bool:
        """Keep the report of an incident; return whether it is stored."""
        try:
            with self.database.write_session() as session:
                is_new = add_incident(session, robot_id, report, self.clock())
        except SQLAlchemyError as error:
            log.error("an incident is not stored: %s", type(error).__name__)  # noqa: TRY400
            return False
        if is_new:
            self.hub.broadcast(INCIDENT_MESSAGE)
        return True

    def find_plan_document(self, robot: str, digest: str) -> str | None:
        """Return the plan document that the newest settings of a robot name; None for another."""
        try:
            with self.database.session() as session:
                _, app = find_robot(session, robot) or (None, None)
                row = newest_settings(session, app.id) if app else None
                if row is None or load_settings(row).plan != digest:
                    return None
                return find_plan_document(session, digest)
        except SQLAlchemyError as error:
            log.error("%s gets no plan: %s", robot, type(error).__name__)  # noqa: TRY400
            return None

    def _store_batches(self, batches: Sequence[EventBatch]) -> Sequence[StoredEvent]:
        start = time.perf_counter()
        with self.database.write_session() as session:
            now = self.clock()
            added = add_events(session, now, batches)
            if added:
                ids = tuple(int(each.row["id"]) for each in _most_severe(added))
                post_notice(session, EventsNotice(ids=ids))
            left = end_acknowledgements(session, now, added)
        self.counters.transactions += 1
        self.counters.transaction_seconds += time.perf_counter() - start
        for robot, acknowledged in left.items():
            self.hub.broadcast_change(robot, acknowledged_change(acknowledged))
        return added

    def _note_stored(self, added: Sequence[StoredEvent], events: int) -> None:
        self.counters.stored_events += len(added)
        self.counters.duplicate_events += events - len(added)
        for each in added:
            if each.row["kind"] == EventKind.LOST:
                self.hub.add_lost_events(each.robot, lost_event_count(each.row["values"]))
        if self.hub.has_listeners:
            self._broadcast(added)

    def _count_pruned(self, events: int) -> None:
        self.counters.pruned_events += events

    def _broadcast(self, added: Sequence[StoredEvent]) -> None:
        for each in _most_severe(added):
            self.hub.broadcast(event_message(each.view()))

    def _load_lost_events(self) -> None:
        with self.database.session() as session:
            for robot, events in lost_events_by_robot(session).items():
                self.hub.add_lost_events(robot, events)


def event_message(event: EventView) -> LiveMessage:
    """Return the live message of an event."""
    return {"type": "event", "event": event.model_dump(mode="json")}


def _most_severe(added: Sequence[StoredEvent]) -> Sequence[StoredEvent]:
    """Return what is told live of a transaction, in the order of storing."""
    if len(added) <= MAX_LIVE_EVENTS:
        return added
    by_level = sorted(added, key=lambda each: _LEVELS.index(each.row["level"]))
    return sorted(by_level[-MAX_LIVE_EVENTS:], key=lambda each: int(each.row["id"]))
