"""How a change becomes a revision: checked against the newest, stored, then sent to the guard.

What was answered is in the database before. A stop that went out although it could not be stored is
stored before whatever comes next.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
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
from rtron.service.controller.settings_sender import SettingsSender
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock, SteadyClock
from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.risk_model import node_json
from rtron.service.domain.schemas import SettingsView
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
