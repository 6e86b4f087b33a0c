"""How a change becomes a revision: checked against the newest, stored, then sent to the guard.

What was answered is in the database before. A stop that went out although it could not be stored is
stored before whatever comes next.
"""

from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from threading import RLock
from typing import TypeVar

from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan
from rtron.errors import RTronError
from rtron.service.controller.robot_snapshot import (
    RobotSnapshot,
    drop_expired_overrides,
    last_accepted_settings,
    load_snapshot,
)
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock, SteadyClock
from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.revisions import add_stop
from rtron.service.domain.risk_model import node_json
from rtron.service.domain.schemas import SettingsView
from rtron.service.live.hub import Hub
from rtron.service.store.audit import record_event, record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.robots import store_policy_settings
from rtron.service.store.settings import (
    ChangeAuthor,
    add_settings,
    announce_settings,
    load_settings,
    settings_view,
    with_settings,
)
from rtron.vocabulary import Settings

_LOCK_COUNT = 64


class SettingsSender:
    """What was last sent to each robot, and which emergency stops are not stored yet.

    Whoever stores settings holds `robot_lock` from before that until they are sent.
    """

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._locks = tuple(RLock() for _ in range(_LOCK_COUNT))
        self._last_sent: dict[str, Settings] = {}
        self._unstored_stops: dict[str, Settings] = {}

    def robot_lock(self, robot: str) -> RLock:
        """Return the lock of a robot, which may be another's too."""
        return self._locks[_lock_number(robot)]

    @contextmanager
    def robot_locks(self, robots: Collection[str]) -> Iterator[None]:
        """Hold the locks of robots, taken in one order for all who want several."""
        with ExitStack() as held:
            for number in sorted(set(map(_lock_number, robots))):
                held.enter_context(self._locks[number])
            yield

    def note_guard_settings(self, robot: str, settings: Settings) -> None:
        """Note what a guard has in force: a stop that cannot be stored has to go above that."""
        last_sent = self._last_sent.get(robot, Settings())
        self._last_sent[robot] = max(settings, last_sent, key=lambda each: each.revision)

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings that are stored."""
        self._hub.push(robot, settings)
        self.note_sent(robot, settings)

    def push_stored(self, robot: str, settings: Settings) -> None:
        """Send settings that another replica has stored, unless newer ones are sent."""
        self._hub.push(robot, settings)
        if settings.revision >= self._last_sent.get(robot, Settings()).revision:
            self.note_sent(robot, settings)

    def note_sent(self, robot: str, settings: Settings) -> None:
        """Note that settings that are stored are sent, as the answer to a hello."""
        self._last_sent[robot] = settings
        unstored = self._unstored_stops.get(robot)
        if unstored and unstored.revision < settings.revision:
            del self._unstored_stops[robot]

    def is_connected(self, robot: str) -> bool:
        """Tell whether the robot's guard is connected here."""
        return self._hub.is_connected(robot)

    def send_unstored_stop(self, robot: str, actor: str, reason: str, now: int) -> bool:
        """Send a stop on top of what was last sent, to be stored before what comes next.

        Return whether it is on its way; if not, it waits for the robot.
        """
        previous = self._unstored_stops.get(robot) or self._last_sent.get(robot, Settings())
        self._unstored_stops[robot] = settings = add_stop(previous, actor, reason, now)
        return self._hub.push(robot, settings)

    def unstored_stop(self, robot: str) -> Settings | None:
        """Return the stop that is sent, but not stored."""
        return self._unstored_stops.get(robot)

    def discard_unstored_stop(self, robot: str) -> None:
        """Drop the stop of a robot that there is not."""
        self._unstored_stops.pop(robot, None)

    def broadcast(self, robot: str, view: SettingsView) -> None:
        """Tell everybody who watches of settings."""
        message = {"type": "settings", "robot": robot, "view": view.model_dump(mode="json")}
        self._hub.broadcast(message)


def _lock_number(robot: str) -> int:
    return hash(robot) % _LOCK_COUNT


_MAX_ATTEMPTS = 100
_T = TypeVar("_T")
ApplyChange = Callable[[Session, RobotSnapshot], EffectivePlan | None]
"""Makes new settings of the newest ones; None if they are to stay as they are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RevisionWriter:
    """Writes revisions of any robot; from any thread."""

    database: Database
    sender: SettingsSender
    clock: Clock
    steady_clock: SteadyClock

    def revise(
        self, robot: str, event: AuditEvent, apply: ApplyChange, reason: str
    ) -> SettingsView:
        """Write what `apply` makes of the newest settings; None if they are to stay as they are."""
        with self.sender.robot_lock(robot), self._record_refusals(event):
            self.store_unstored_stop(robot)
            return retry_conflicts(lambda: self._write(robot, event, apply, reason))

    def store_unstored_stop(self, robot: str) -> None:
        """Store, above what was sent, the stop that went out although it could not be stored."""
        sent = self.sender.unstored_stop(robot)
        if sent is None or sent.stop is None:
            return
        stop = sent.stop

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            next_revision = max(snapshot.settings.revision, sent.revision) + 1
            after = replace(snapshot.settings, stop=stop, revision=next_revision)
            return EffectivePlan(snapshot.plan, after)

        event = AuditEvent(who=stop.by, action="stop", target=robot, detail={"reason": stop.reason})
        try:
            retry_conflicts(lambda: self._write(robot, event, apply, stop.reason))
        except NotFoundError:
            self.sender.discard_unstored_stop(robot)

    def _write(
        self, robot: str, event: AuditEvent, apply: ApplyChange, reason: str
    ) -> SettingsView:
        now, steady_now = self.clock(), self.steady_clock()
        with self.database.write_session(durable=True, urgent=True) as session:
            snapshot = load_snapshot(session, robot)
            accepted = last_accepted_settings(session, snapshot)
            active = drop_expired_overrides(accepted, snapshot.row.at, steady_now)
            snapshot = replace(snapshot, settings=active)
            effective = apply(session, snapshot)
            row = snapshot.row
            if effective:
                author = ChangeAuthor(by=event.who, reason=reason, at=steady_now)
                row = add_settings(session, snapshot.app.id, effective.settings, author)
                if effective.settings.nodes != load_settings(snapshot.row).nodes:
                    in_force = node_json(effective.plan)
                    store_policy_settings(session, snapshot.app.id, in_force)
                record_event(session, now, with_settings(event, snapshot.app, row))
                announce_settings(session, robot, row)
            else:
                record_repeatable(session, now, event, "done")
        view = settings_view(row)
        if effective:
            self.sender.push(robot, effective.settings)
            self.sender.broadcast(robot, view)
        return view

    @contextmanager
    def _record_refusals(self, event: AuditEvent) -> Iterator[None]:
        """Write into the audit log why something is refused; without the log it is refused too."""
        try:
            yield
        except RTronError as error:
            with suppress(SQLAlchemyError), self.database.write_session() as session:
                record_repeatable(session, self.clock(), event, f"refused: {error}")
            raise


def retry_conflicts(attempt: Callable[[], _T]) -> _T:
    """Return what an attempt returns; as often as somebody else was faster, try again."""
    for _ in range(_MAX_ATTEMPTS):
        with suppress(IntegrityError):
            return attempt()
    raise ConflictError("too many change this at the same moment", help="try again")
