"""The data collector (paper section 6.3): what guards tell is stored, and what is live is told."""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.event_writer import Intake
from rtron.service.collector.greeting import Greeting
from rtron.service.collector.tally import Tally
from rtron.service.domain.clock import Clock
from rtron.service.live.hub import Hub
from rtron.service.store.database import Database
from rtron.service.store.events import Added, Batch, add_events, lost, lost_events
from rtron.service.store.retention import Bounds, forget
from rtron.service.store.robots import find_robot, meet_robot, plan_digest, plan_json
from rtron.service.store.settings import newest, settings_of
from rtron.vocabulary import EventKind, Level, Settings
from rtron.wire.common.link_protocol import Applied, Hello

log = logging.getLogger(__name__)

Authenticate = Callable[[str], str | None]
"""Returns the robot that a token speaks for, or None; called in a thread."""

MOST_TOLD = 200
"""So many events of one transaction are told live, those of the highest level first."""
_RETAIN_S = 60.0
_PAUSE_S = 0.01
_LEVELS = tuple(Level)


@dataclass(frozen=True, slots=True, kw_only=True)
class Patience:
    """How long a guard may take, s: to say hello, between two messages, to read one.

    After `token` seconds, again and again, it is asked whether the token still holds.
    """

    hello: float = 10.0
    silence: float = 30.0
    sending: float = 10.0
    token: float = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Collector:
    """What all connections of guards share; it works while it is `running`."""

    database: Database
    hub: Hub
    greeting: Greeting
    authenticate: Authenticate
    clock: Clock
    bounds: Bounds
    patience: Patience = field(default_factory=Patience)
    tally: Tally = field(default_factory=Tally)
    intake: Intake = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "intake", Intake(self._store, self._stored))

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Store and forget events until the end of the block."""
        await asyncio.to_thread(self._recall)
        tasks = [asyncio.create_task(each) for each in (self.intake.run(), self._retain())]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    def greet(self, robot: str, hello: Hello) -> Settings:
        """Return what to put in force; if nothing can be stored, the newest that is known."""
        try:
            return self.greeting.greet(robot, hello)
        except SQLAlchemyError as error:
            log.error("%s is greeted, which is not stored: %s", robot, type(error).__name__)  # noqa: TRY400
        known = (hello.settings, self._newest(robot, hello), self.hub.pushed(robot))
        return max(known, key=lambda settings: settings.revision)

    def _newest(self, robot: str, hello: Hello) -> Settings:
        """Return the newest settings of a guard's app, if they were made for its plan."""
        with self.database.session() as session:
            _, app = find_robot(session, robot) or (None, None)
            if app is None or app.name != hello.app:
                return Settings()
            row = newest(session, app.id)
            is_same = app.digest == plan_digest(plan_json(hello.plan))
            return settings_of(row) if row and is_same else Settings()

    def answered(self, robot: str, applied: Applied) -> None:
        """Hand on what a guard answers; if that cannot be stored, it goes on all the same."""
        try:
            self.greeting.answered(robot, applied)
        except SQLAlchemyError as error:
            log.error("%s has answered, which is not stored: %s", robot, type(error).__name__)  # noqa: TRY400

    def meet(self, robot: str) -> int | None:
        """Return the robot's id, and note that it was seen now; None if it can be neither."""
        try:
            with self.database.writing() as session:
                return meet_robot(session, robot, self.clock()).id
        except SQLAlchemyError as error:
            log.warning("%s is connected, which is not noted: %s", robot, type(error).__name__)
        with self.database.session() as session:
            found = find_robot(session, robot)
        return found[0].id if found else None

    def _store(self, batches: Sequence[Batch]) -> Sequence[Added]:
        start = time.perf_counter()
        with self.database.writing() as session:
            added = add_events(session, self.clock(), batches)
        self.tally.batches += 1
        self.tally.seconds += time.perf_counter() - start
        return added

    def _stored(self, added: Sequence[Added], events: int) -> None:
        self.tally.stored += len(added)
        self.tally.repeated += events - len(added)
        for each in added:
            if each.row["kind"] == EventKind.LOST:
                self.hub.lose(each.robot, lost(each.row["values"]))
        if self.hub.listened:
            self._tell(added)

    def _tell(self, added: Sequence[Added]) -> None:
        told = added
        if len(added) > MOST_TOLD:
            by_level = sorted(added, key=lambda each: _LEVELS.index(each.row["level"]))
            told = sorted(by_level[-MOST_TOLD:], key=lambda each: int(each.row["id"]))
        for each in told:
            self.hub.tell({"type": "event", "event": each.view().model_dump(mode="json")})

    def _recall(self) -> None:
        with self.database.session() as session:
            for robot, events in lost_events(session).items():
                self.hub.lose(robot, events)

    async def _retain(self) -> None:
        while True:
            try:
                await self._forget()
            except SQLAlchemyError as error:
                log.error("old events are not deleted: %s", type(error).__name__)  # noqa: TRY400
            await asyncio.sleep(_RETAIN_S)

    async def _forget(self) -> None:
        slices = forget(self.database, self.bounds, self.clock())
        while (deleted := await asyncio.to_thread(next, slices, None)) is not None:
            self.tally.forgotten += deleted
            await asyncio.sleep(_PAUSE_S)
