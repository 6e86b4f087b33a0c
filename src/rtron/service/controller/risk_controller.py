"""The risk controller (paper section 6.3): people's settings, checked, kept, sent to the guards.

What was answered is in the database before. Each change is one new revision, and whoever was
overtaken has to look again; the emergency stop is not overtaken: it goes on top of the newest.
"""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import TypeVar

from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan
from rtron.errors import RTronError, SourceError
from rtron.service.controller.handshake import HelloRateLimit, check_hello, perform_handshake
from rtron.service.controller.robot_snapshot import (
    RobotSnapshot,
    drop_expired_overrides,
    last_accepted_settings,
    load_current_app,
    load_snapshot,
)
from rtron.service.controller.settings_sender import SettingsSender
from rtron.service.domain.audit_events import (
    AuditEvent,
    node_target,
    settings_answer_event,
    truncated_json,
)
from rtron.service.domain.clock import Clock
from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.principal import Principal
from rtron.service.domain.revisions import (
    StaleRevisionError,
    add_override,
    add_stop,
    apply_change,
    check_override_right,
    check_stop_right,
    is_same_stop,
    remove_override,
    remove_stop,
)
from rtron.service.domain.risk_model import node_json
from rtron.service.domain.schemas import (
    OverrideRequest,
    ReleaseRequest,
    SettingsChange,
    SettingsOutcome,
    SettingsView,
)
from rtron.service.live.hub import Hub
from rtron.service.store.audit import record_event, record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.robots import store_policy_settings
from rtron.service.store.settings import (
    ChangeAuthor,
    add_settings,
    find_revision,
    load_settings,
    record_answer,
    settings_view,
)
from rtron.vocabulary import Settings
from rtron.wire.common.link_protocol import Applied, Hello

log = logging.getLogger(__name__)
_MAX_ATTEMPTS = 100
_SERVICE_ACTOR = "rtron"
_T = TypeVar("_T")
_ApplyChange = Callable[[Session, RobotSnapshot], EffectivePlan | None]


class RiskController:
    """Keeps the settings of every robot. All methods may be called from any thread.

    They raise NotFoundError for a robot or node that is not known, ForbiddenError where the
    caller's roles do not suffice, InputError for what makes no plan. Every attempt, and what came
    of it, stands in the audit log.
    """

    def __init__(self, database: Database, hub: Hub, clock: Clock) -> None:
        self._database = database
        self._sender = SettingsSender(hub)
        self._clock = clock
        self._recorded_dry_runs: dict[str, str] = {}
        self._hello_rate_limit = HelloRateLimit()

    def handle_hello(self, robot: str, hello: Hello) -> Settings:
        """Store a guard's app, plan and coordination nodes; return what it is to put in force.

        Settings that no longer fit the plan are left out, as a new revision.
        """

        def store() -> Settings:
            now = self._clock()
            with self._database.write_session(durable=True) as session:
                handshake = perform_handshake(session, robot, hello, now)
                if handshake.is_changed:
                    self._hello_rate_limit.count(robot, now)
                self._record_dry_run(session, robot, hello)
            if handshake.is_new:
                self._sender.broadcast(robot, settings_view(handshake.row))
            return handshake.settings

        check_hello(hello)
        with self._sender.robot_lock(robot):
            self._sender.note_guard_settings(robot, hello.settings)
            self._store_unstored_stop(robot)
            settings = _retry_conflicts(store)
            self._sender.note_sent(robot, settings)
            return settings

    def handle_applied(self, robot: str, applied: Applied) -> None:
        """Note what a guard has made of settings; one that refuses a stop gets it on its own."""
        now = self._clock()
        with self._database.write_session() as session:
            app = load_current_app(session, robot)
            row = find_revision(session, app.id, applied.revision)
            if row is None:
                log.warning("%s answers revision %d, which is none", robot, applied.revision)
                return
            outcome = SettingsOutcome.REFUSED if applied.error else SettingsOutcome.APPLIED
            is_new = record_answer(session, row, outcome, applied.error, now)
            if is_new:
                record_repeatable(
                    session, now, settings_answer_event(robot, applied), outcome.value
                )
            settings, view = load_settings(row), settings_view(row)
        if is_new:
            self._sender.broadcast(robot, view)
        if applied.error and settings.stop:
            self._resend_stop(robot, settings)

    def change(self, caller: Principal, robot: str, change: SettingsChange) -> SettingsView:
        """Merge a change into the settings; StaleRevisionError if its revision is not the newest.

        A change that changes nothing makes no revision.
        """
        event = caller.audit_event(
            "settings",
            robot,
            revision=change.revision,
            nodes=truncated_json(change.nodes),
            reason=change.reason,
        )

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan | None:
            if change.revision != snapshot.row.revision:
                raise StaleRevisionError(settings_view(snapshot.row))
            after = apply_change(snapshot.plan, snapshot.settings, caller.roles, change)
            again = snapshot.row.error or after.settings.nodes != snapshot.settings.nodes
            return after if again else None

        return self._revise(robot, event, apply, change.reason)

    def start_override(
        self, caller: Principal, robot: str, node: str, request: OverrideRequest
    ) -> SettingsView:
        """Let pass for a while what a coordination node forbids."""
        event = caller.audit_event(
            "override", node_target(robot, node), duration=request.duration, reason=request.reason
        )

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            check_override_right(snapshot.plan, caller.roles, node)
            now = self._clock()
            after = add_override(snapshot.settings, caller.name, node, request, now)
            return EffectivePlan(snapshot.plan, after)

        return self._revise(robot, event, apply, request.reason)

    def end_override(self, caller: Principal, robot: str, node: str) -> SettingsView:
        """Put a coordination node in force again before its override is over."""

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            check_override_right(snapshot.plan, caller.roles, node)
            return EffectivePlan(snapshot.plan, remove_override(snapshot.settings, node))

        return self._revise(
            robot, caller.audit_event("override.end", node_target(robot, node)), apply, ""
        )

    def start_emergency_stop(self, caller: Principal, robot: str, reason: str) -> SettingsView:
        """Stop a robot until it is released; the same stop goes out again unless it is in force.

        Another's stop, or one for another reason, takes its place, as a revision of its own. Where
        the database does not take it, it goes out all the same, and SourceError tells.
        """

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan | None:
            check_stop_right(caller.roles)
            stop = snapshot.settings.stop
            is_confirmed = snapshot.row.outcome == SettingsOutcome.APPLIED
            if is_confirmed and stop and is_same_stop(stop, caller.name, reason):
                return None
            after = add_stop(snapshot.settings, caller.name, reason, self._clock())
            return EffectivePlan(snapshot.plan, after)

        with self._sender.robot_lock(robot):
            try:
                return self._revise(
                    robot, caller.audit_event("stop", robot, reason=reason), apply, reason
                )
            except SQLAlchemyError as error:
                check_stop_right(caller.roles)
                log.exception("the emergency stop of %s is not stored", robot)
                self._sender.send_unstored_stop(robot, caller.name, reason, self._clock())
                message = f"the stop is sent, but not stored: {type(error).__name__}"
                raise SourceError(message, help="is the disk full, or the database away?") from None

    def release_emergency_stop(
        self, caller: Principal, robot: str, request: ReleaseRequest
    ) -> SettingsView:
        """End the emergency stop of a revision; StaleRevisionError if that is not the newest."""

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            check_stop_right(caller.roles)
            if request.revision != snapshot.row.revision:
                raise StaleRevisionError(settings_view(snapshot.row))
            return EffectivePlan(snapshot.plan, remove_stop(snapshot.settings, request.reason))

        detail = {"revision": request.revision, "reason": request.reason}
        return self._revise(
            robot, caller.audit_event("stop.end", robot, **detail), apply, request.reason
        )

    def _record_dry_run(self, session: Session, robot: str, hello: Hello) -> None:
        """Write once for each life of a guard that it forbids nothing."""
        if hello.dry_run and self._recorded_dry_runs.get(robot) != hello.run:
            event = AuditEvent(
                who=f"guard:{robot}", action="dry_run", target=robot, detail={"run": hello.run}
            )
            record_repeatable(session, self._clock(), event, "done")
            self._recorded_dry_runs[robot] = hello.run

    def _revise(
        self, robot: str, event: AuditEvent, apply: _ApplyChange, reason: str
    ) -> SettingsView:
        """Write what `apply` makes of the newest settings; None if they are to stay as they are."""
        with self._sender.robot_lock(robot), self._record_refusals(event):
            self._store_unstored_stop(robot)
            return _retry_conflicts(lambda: self._write_revision(robot, event, apply, reason))

    def _write_revision(
        self, robot: str, event: AuditEvent, apply: _ApplyChange, reason: str
    ) -> SettingsView:
        now = self._clock()
        with self._database.write_session(durable=True) as session:
            snapshot = load_snapshot(session, robot)
            snapshot = replace(
                snapshot,
                settings=drop_expired_overrides(last_accepted_settings(session, snapshot), now),
            )
            effective = apply(session, snapshot)
            row = snapshot.row
            if effective:
                author = ChangeAuthor(by=event.who, reason=reason, at=now)
                row = add_settings(session, snapshot.app.id, effective.settings, author)
                if effective.settings.nodes != load_settings(snapshot.row).nodes:
                    in_force = node_json(effective.plan)
                    store_policy_settings(session, snapshot.app.id, in_force)
                record_event(session, now, event)
            else:
                record_repeatable(session, now, event, "done")
        view = settings_view(row)
        if effective:
            self._sender.push(robot, effective.settings)
            self._sender.broadcast(robot, view)
        return view

    def _store_unstored_stop(self, robot: str) -> None:
        """Store, above what was sent, the stop that went out although it could not be stored."""
        sent = self._sender.unstored_stop(robot)
        if sent is None or sent.stop is None:
            return
        stop = sent.stop

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            next_revision = max(snapshot.settings.revision, sent.revision) + 1
            after = replace(snapshot.settings, stop=stop, revision=next_revision)
            return EffectivePlan(snapshot.plan, after)

        event = AuditEvent(who=stop.by, action="stop", target=robot, detail={"reason": stop.reason})
        try:
            _retry_conflicts(lambda: self._write_revision(robot, event, apply, stop.reason))
        except NotFoundError:
            self._sender.discard_unstored_stop(robot)

    def _resend_stop(self, robot: str, refused: Settings) -> None:
        """Send a stop that was refused again, with what the guard last took, or with nothing."""
        event = AuditEvent(who=_SERVICE_ACTOR, action="stop", target=robot)

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            last = snapshot.settings
            nodes = {} if last.nodes == load_settings(snapshot.row).nodes else last.nodes
            after = replace(last, nodes=nodes, revision=last.revision + 1)
            return EffectivePlan(snapshot.plan, after)

        with self._sender.robot_lock(robot):
            with self._database.session() as session:
                row = load_snapshot(session, robot).row
            if row.revision == refused.revision and refused.nodes:
                reason = f"the guard refused revision {refused.revision}; the stop stays"
                self._revise(robot, event, apply, reason)

    @contextmanager
    def _record_refusals(self, event: AuditEvent) -> Iterator[None]:
        """Write into the audit log why something is refused; without the log it is refused too."""
        try:
            yield
        except RTronError as error:
            with suppress(SQLAlchemyError), self._database.write_session() as session:
                record_repeatable(session, self._clock(), event, f"refused: {error}")
            raise


def _retry_conflicts(attempt: Callable[[], _T]) -> _T:
    """Return what an attempt returns; as often as somebody else was faster, try again."""
    for _ in range(_MAX_ATTEMPTS):
        with suppress(IntegrityError):
            return attempt()
    raise ConflictError("too many change this at the same moment", help="try again")
