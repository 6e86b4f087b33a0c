"""The risk controller (paper section 6.3): people's settings, checked, kept, sent to the guards.

What was answered is in the database before. Each change is one new revision, and whoever was
overtaken has to look again; the emergency stop is not overtaken: it goes on top of the newest.
"""

import logging
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import replace

from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan
from rtron.errors import RTronError, SourceError
from rtron.service.controller.fleet_stop import (
    Failures,
    FleetStop,
    StoredStops,
    record_failures,
    store_stops,
)
from rtron.service.controller.handshake import (
    HelloRateLimit,
    check_hello,
    is_known,
    perform_handshake,
)
from rtron.service.controller.revision_writer import (
    ApplyChange,
    RevisionWriter,
    SettingsSender,
    retry_conflicts,
)
from rtron.service.controller.robot_snapshot import (
    RobotSnapshot,
    active_settings,
    last_accepted_settings,
    load_current_app,
    load_snapshot,
)
from rtron.service.domain.audit_events import (
    AuditEvent,
    node_target,
    settings_answer_event,
    truncated_json,
)
from rtron.service.domain.clock import Clock, SteadyClock
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.principal import Principal
from rtron.service.domain.revisions import (
    add_override,
    add_stop,
    apply_change,
    check_override_right,
    check_stop_right,
    is_same_stop,
    remove_override,
    remove_stop,
    restore_nodes,
)
from rtron.service.domain.rollouts.plans import checked_answer
from rtron.service.domain.schemas import (
    OverrideRequest,
    ReleaseRequest,
    RestoreRequest,
    SettingsChange,
    SettingsOutcome,
    SettingsView,
)
from rtron.service.live.hub import Hub
from rtron.service.store.audit import record_repeatable
from rtron.service.store.database import Database
from rtron.service.store.settings import (
    announce_settings,
    find_revision,
    load_settings,
    newest_settings_by_robot,
    record_answer,
    settings_view,
)
from rtron.vocabulary import Settings
from rtron.wire.common.link_protocol import Applied, Hello

log = logging.getLogger(__name__)
_SERVICE_ACTOR = "rtron"
_MAX_NAMED = 5
_SENT = "is sent, but not stored"
_NEITHER = "is neither sent nor stored"
StopElsewhere = Callable[[Collection[str], str, str], Collection[str]]
"""Lets other replicas send a stop: of which robots, who and why; returns those that have it."""


def _nowhere(_robots: Collection[str], _actor: str, _reason: str) -> Collection[str]:
    return ()


class RiskController:
    """Keeps the settings of every robot. All methods may be called from any thread.

    They raise NotFoundError for a robot or node that is not known, ForbiddenError where the
    caller's roles do not suffice, InputError for what makes no plan. Every attempt, and what came
    of it, stands in the audit log.
    """

    def __init__(
        self, database: Database, hub: Hub, clock: Clock, steady_clock: SteadyClock
    ) -> None:
        """`clock` says when something was done; what lasts for a while is by `steady_clock`."""
        self._database = database
        self.stop_elsewhere: StopElsewhere = _nowhere
        self._sender = SettingsSender(hub)
        self._clock, self._steady_clock = clock, steady_clock
        self._writer = RevisionWriter(
            database=database, sender=self._sender, clock=clock, steady_clock=steady_clock
        )
        self._recorded_dry_runs: dict[str, str] = {}
        self._hello_rate_limit = HelloRateLimit()

    def handle_hello(self, robot: str, hello: Hello) -> Settings:
        """Store a guard's app, plan and coordination nodes; return what it is to put in force.

        Settings that no longer fit the plan are left out, as a new revision.
        """

        def store() -> Settings:
            now, is_new = self._steady_clock(), self._is_new_to(robot, hello)
            with self._database.write_session(durable=is_new) as session:
                handshake = perform_handshake(session, robot, hello, now)
                if handshake.is_changed:
                    self._hello_rate_limit.count(robot, now)
                self._record_dry_run(session, robot, hello)
                if handshake.is_new:
                    announce_settings(session, robot, handshake.row)
            if handshake.is_new:
                self._sender.broadcast(robot, settings_view(handshake.row))
            return active_settings(handshake.row, now)

        check_hello(hello)
        with self._sender.robot_lock(robot):
            self._sender.note_guard_settings(robot, hello.settings)
            self._writer.store_unstored_stop(robot)
            settings = retry_conflicts(store)
            self._sender.note_sent(robot, settings)
            return settings

    def _is_new_to(self, robot: str, hello: Hello) -> bool:
        """Tell whether a hello says what SQLite has not stored, and is to keep over a power cut."""
        if not self._database.is_sqlite:
            return False
        with self._database.session() as session:
            return not is_known(session, robot, hello)

    def handle_applied(self, robot: str, applied: Applied) -> None:
        """Note what a guard has made of settings; one that refuses a stop gets it on its own."""
        now = self._clock()
        with self._database.write_session(urgent=True) as session:
            app = load_current_app(session, robot)
            row = find_revision(session, app.id, applied.revision)
            if row is None:
                log.warning("%s answers revision %d, which is none", robot, applied.revision)
                return
            applied = checked_answer(applied, load_settings(row))
            outcome = SettingsOutcome.REFUSED if applied.error else SettingsOutcome.APPLIED
            is_new = record_answer(session, row, outcome, applied.error, now)
            if is_new:
                record_repeatable(
                    session, now, settings_answer_event(robot, applied), outcome.value
                )
                announce_settings(session, robot, row)
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
            snapshot.check_newest(change.revision)
            after = apply_change(snapshot.plan, snapshot.settings, caller.roles, change)
            return after if snapshot.differs(after.settings) else None

        return self.revise(robot, event, apply, change.reason)

    def restore(self, caller: Principal, robot: str, request: RestoreRequest) -> SettingsView:
        """Put the nodes' settings of an earlier revision in force again, as a new revision.

        Overrides and the emergency stop stay as they are. StaleRevisionError as with a change.
        """
        detail = {"restored": request.restored, "reason": request.reason}
        event = caller.audit_event("settings.restore", robot, revision=request.revision, **detail)

        def apply(session: Session, snapshot: RobotSnapshot) -> EffectivePlan | None:
            snapshot.check_newest(request.revision)
            earlier = find_revision(session, snapshot.app.id, request.restored)
            if earlier is None:
                raise NotFoundError(f"there is no revision {request.restored}")
            nodes = load_settings(earlier)
            after = restore_nodes(snapshot.plan, snapshot.settings, caller.roles, nodes)
            return after if snapshot.differs(after.settings) else None

        return self.revise(robot, event, apply, request.reason)

    def start_override(
        self, caller: Principal, robot: str, node: str, request: OverrideRequest
    ) -> SettingsView:
        """Let pass for a while what a coordination node forbids."""
        event = caller.audit_event(
            "override", node_target(robot, node), duration=request.duration, reason=request.reason
        )

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            check_override_right(snapshot.plan, caller.roles, node)
            now = self._steady_clock()
            after = add_override(snapshot.settings, caller.name, node, request, now)
            return EffectivePlan(snapshot.plan, after)

        return self.revise(robot, event, apply, request.reason)

    def end_override(self, caller: Principal, robot: str, node: str, reason: str) -> SettingsView:
        """Put a coordination node in force again before its override is over."""

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            check_override_right(snapshot.plan, caller.roles, node)
            return EffectivePlan(snapshot.plan, remove_override(snapshot.settings, node, reason))

        event = caller.audit_event("override.end", node_target(robot, node), reason=reason)
        return self.revise(robot, event, apply, reason)

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
                return self.revise(
                    robot, caller.audit_event("stop", robot, reason=reason), apply, reason
                )
            except SQLAlchemyError as error:
                check_stop_right(caller.roles)
                stop = FleetStop(caller=caller, robots=[robot], reason=reason)
                raise self._send_unstored_stops(stop, error)[robot] from None

    def start_emergency_stops(self, stop: FleetStop) -> Failures:
        """Stop several robots, each as if it were stopped alone; return why some are not.

        They are stored in one transaction, and sent when it is committed.
        """
        check_stop_right(stop.caller.roles)
        stop, failures = stop.within_reach(self._database)
        with self._sender.robot_locks(stop.robots):
            try:
                for robot in stop.robots:
                    self._writer.store_unstored_stop(robot)
                stored = retry_conflicts(lambda: self._store_stops(stop, failures))
            except SQLAlchemyError as error:
                return failures | self._send_unstored_stops(stop, error)
            for robot, (settings, view) in stored.sent.items():
                self._sender.push(robot, settings)
                self._sender.broadcast(robot, view)
        failures |= stored.failures
        for robot in stored.singly:
            failures |= self._stop_one(stop, robot)
        return failures

    def _stop_one(self, stop: FleetStop, robot: str) -> Failures:
        try:
            self.start_emergency_stop(stop.caller, robot, stop.reason)
        except RTronError as error:
            return {robot: error}
        return {}

    def _store_stops(self, stop: FleetStop, failures: Failures) -> StoredStops:
        with self._database.write_session(durable=True, urgent=True) as session:
            now = self._clock()
            record_failures(session, stop, failures, now)
            return store_stops(session, stop, now, self._steady_clock())

    def send_requested_stop(self, robot: str, actor: str, reason: str) -> bool:
        """Send a stop that another replica cannot store, if the guard is connected here."""
        return self._sender.is_connected(robot) and self._sender.send_unstored_stop(
            robot, actor, reason, self._clock()
        )

    def push_stored(self, robots: Collection[str]) -> None:
        """Send the newest settings to these robots' guards: another replica may have stored them.

        A stop that could not be stored here goes on top of them.
        """
        with self._database.session() as session:
            rows = newest_settings_by_robot(session, robots)
        for robot, row in rows.items():
            if self._sender.unstored_stop(robot):
                with self._sender.robot_lock(robot):
                    self._writer.store_unstored_stop(robot)
            else:
                self._sender.push_stored(robot, load_settings(row))

    def release_emergency_stop(
        self, caller: Principal, robot: str, request: ReleaseRequest
    ) -> SettingsView:
        """End the emergency stop of a revision; StaleRevisionError if that is not the newest."""

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            check_stop_right(caller.roles)
            snapshot.check_newest(request.revision)
            return EffectivePlan(snapshot.plan, remove_stop(snapshot.settings, request.reason))

        detail = {"revision": request.revision, "reason": request.reason}
        event = caller.audit_event("stop.end", robot, **detail)
        return self.revise(robot, event, apply, request.reason)

    def _send_unstored_stops(self, stop: FleetStop, cause: SQLAlchemyError) -> Failures:
        """Send stops that cannot be stored; return what is true of each."""
        names = ", ".join(list(stop.robots)[:_MAX_NAMED])
        log.error("%d emergency stops are not stored: %s", len(stop.robots), names, exc_info=cause)
        away = [robot for robot in stop.robots if not self._sender.is_connected(robot)]
        elsewhere = {} if self._database.is_sqlite else self._send_elsewhere(stop, away)
        deliveries = {
            robot: self._send_unstored_stop(robot, stop)
            for robot in stop.robots
            if robot not in elsewhere
        }
        help = "is the disk full, or the database away?"
        return {
            robot: SourceError(f"the stop {delivery}: {type(cause).__name__}", help=help)
            for robot, delivery in (deliveries | elsewhere).items()
        }

    def _send_unstored_stop(self, robot: str, stop: FleetStop) -> str:
        now = self._clock()
        is_sent = self._sender.send_unstored_stop(robot, stop.caller.name, stop.reason, now)
        return _SENT if is_sent else "waits for the robot, and is not stored"

    def _send_elsewhere(self, stop: FleetStop, robots: Collection[str]) -> dict[str, str]:
        """Let the replicas that have these robots' guards send stops; return what is true."""
        sent: Collection[str] = ()
        with suppress(SQLAlchemyError):
            sent = self.stop_elsewhere(robots, stop.caller.name, stop.reason) if robots else ()
        return {robot: _SENT if robot in sent else _NEITHER for robot in robots}

    def _record_dry_run(self, session: Session, robot: str, hello: Hello) -> None:
        """Write once for each life of a guard that it forbids nothing."""
        if hello.dry_run and self._recorded_dry_runs.get(robot) != hello.run:
            event = AuditEvent(
                who=f"guard:{robot}", action="dry_run", target=robot, detail={"run": hello.run}
            )
            record_repeatable(session, self._clock(), event, "done")
            self._recorded_dry_runs[robot] = hello.run

    def revise(
        self, robot: str, event: AuditEvent, apply: ApplyChange, reason: str
    ) -> SettingsView:
        """Write what `apply` makes of the newest settings; None if they are to stay as they are."""
        return self._writer.revise(robot, event, apply, reason)

    def _resend_stop(self, robot: str, refused: Settings) -> None:
        """Send a stop that was refused again, with what the guard last took, or with nothing."""
        event = AuditEvent(who=_SERVICE_ACTOR, action="stop", target=robot)

        def apply(_session: Session, snapshot: RobotSnapshot) -> EffectivePlan:
            last = snapshot.settings
            is_same = last.nodes == refused.nodes and last.plan == refused.plan
            nodes = {} if is_same else last.nodes
            after = replace(last, nodes=nodes, revision=last.revision + 1)
            return EffectivePlan(snapshot.plan, after)

        with self._sender.robot_lock(robot):
            with self._database.session() as session:
                snapshot = load_snapshot(session, robot)
                last = last_accepted_settings(session, snapshot)
            has_other = bool(refused.nodes) or last.plan != refused.plan
            if snapshot.row.revision == refused.revision and has_other:
                reason = f"the guard refused revision {refused.revision}; the stop stays"
                self.revise(robot, event, apply, reason)
