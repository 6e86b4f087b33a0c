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

from rtron.errors import RTronError, SourceError
from rtron.service.api.auth.authentication import Caller
from rtron.service.controller.handshake import greeted, refuse_odd
from rtron.service.controller.pace import Pace
from rtron.service.controller.robot_snapshot import (
    Known,
    find_current_app,
    find_known,
    last_good,
    unexpired,
)
from rtron.service.controller.settings_sender import Guards, Outgoing
from rtron.service.domain.audit_events import answer_deed, place, short_nodes
from rtron.service.domain.clock import Clock
from rtron.service.domain.errors import ConflictError, NotFoundError
from rtron.service.domain.revisions import (
    RevisionError,
    allow_override,
    allow_stop,
    changed,
    in_force_again,
    is_same,
    overridden,
    released,
    stopped,
)
from rtron.service.domain.risk_model import node_json
from rtron.service.domain.schemas import (
    OverrideRequest,
    ReleaseRequest,
    SettingsChange,
    SettingsOutcome,
    SettingsView,
)
from rtron.service.store.audit import Deed, record, record_often
from rtron.service.store.database import Database
from rtron.service.store.robots import store_policy_settings
from rtron.service.store.settings import (
    Author,
    add,
    answer,
    revision,
    settings_of,
    settings_view,
)
from rtron.vocabulary import Settings, effective_plan
from rtron.wire.common.link_protocol import Applied, Hello

log = logging.getLogger(__name__)
_MOST_TRIES = 100
_SERVICE = "rtron"
_T = TypeVar("_T")
_Make = Callable[[Session, Known], Settings | None]


class Controller:
    """Keeps the settings of every robot. All methods may be called from any thread.

    They raise NotFoundError for a robot or node that is not known, ForbiddenError where the
    caller's roles do not suffice, InputError for what makes no plan. Every attempt, and what came
    of it, stands in the audit log.
    """

    def __init__(self, database: Database, hub: Guards, clock: Clock) -> None:
        self._database = database
        self._outgoing = Outgoing(hub)
        self._clock = clock
        self._dry_runs: dict[str, str] = {}
        self._pace = Pace()

    def greet(self, robot: str, hello: Hello) -> Settings:
        """Store a guard's app, plan and coordination nodes; return what it is to put in force.

        Settings that no longer fit the plan are left out, as a new revision.
        """

        def store() -> Settings:
            now = self._clock()
            with self._database.writing(durable=True) as session:
                found = greeted(session, robot, hello, now)
                if found.is_changed:
                    self._pace.take(robot, now)
                self._note_dry_run(session, robot, hello)
            if found.is_new:
                self._outgoing.tell(robot, settings_view(found.row))
            return found.settings

        refuse_odd(hello)
        with self._outgoing.alone(robot):
            self._outgoing.meet(robot, hello.settings)
            self._store_unstored(robot)
            settings = _insisting(store)
            self._outgoing.note(robot, settings)
            return settings

    def answered(self, robot: str, applied: Applied) -> None:
        """Note what a guard has made of settings; one that refuses a stop gets it on its own."""
        now = self._clock()
        with self._database.writing() as session:
            app = find_current_app(session, robot)
            row = revision(session, app.id, applied.revision)
            if row is None:
                log.warning("%s answers revision %d, which is none", robot, applied.revision)
                return
            outcome = SettingsOutcome.REFUSED if applied.error else SettingsOutcome.APPLIED
            is_new = answer(session, row, outcome, applied.error, now)
            if is_new:
                record_often(session, now, answer_deed(robot, applied), outcome.value)
            settings, view = settings_of(row), settings_view(row)
        if is_new:
            self._outgoing.tell(robot, view)
        if applied.error and settings.stop:
            self._stop_alone(robot, settings)

    def change(self, caller: Caller, robot: str, change: SettingsChange) -> SettingsView:
        """Merge a change into the settings; RevisionError if its revision is not the newest.

        A change that changes nothing makes no revision.
        """
        deed = caller.deed(
            "settings",
            robot,
            revision=change.revision,
            nodes=short_nodes(change.nodes),
            reason=change.reason,
        )

        def make(_session: Session, known: Known) -> Settings | None:
            if change.revision != known.row.revision:
                raise RevisionError(settings_view(known.row))
            after = changed(known.plan, known.settings, caller.roles, change)
            again = known.row.error or after.nodes != known.settings.nodes
            return after if again else None

        return self._revise(robot, deed, make, change.reason)

    def override(
        self, caller: Caller, robot: str, node: str, request: OverrideRequest
    ) -> SettingsView:
        """Let pass for a while what a coordination node forbids."""
        deed = caller.deed(
            "override", place(robot, node), duration=request.duration, reason=request.reason
        )

        def make(_session: Session, known: Known) -> Settings:
            allow_override(known.plan, caller.roles, node)
            now = self._clock()
            return overridden(known.settings, caller.name, node, request, now)

        return self._revise(robot, deed, make, request.reason)

    def end_override(self, caller: Caller, robot: str, node: str) -> SettingsView:
        """Put a coordination node in force again before its override is over."""

        def make(_session: Session, known: Known) -> Settings:
            allow_override(known.plan, caller.roles, node)
            return in_force_again(known.settings, node)

        return self._revise(robot, caller.deed("override.end", place(robot, node)), make, "")

    def stop(self, caller: Caller, robot: str, reason: str) -> SettingsView:
        """Stop a robot until it is released; the same stop goes out again unless it is in force.

        Another's stop, or one for another reason, takes its place, as a revision of its own. Where
        the database does not take it, it goes out all the same, and SourceError tells.
        """

        def make(_session: Session, known: Known) -> Settings | None:
            allow_stop(caller.roles)
            stop = known.settings.stop
            is_confirmed = known.row.outcome == SettingsOutcome.APPLIED
            if is_confirmed and stop and is_same(stop, caller.name, reason):
                return None
            return stopped(known.settings, caller.name, reason, self._clock())

        with self._outgoing.alone(robot):
            try:
                return self._revise(robot, caller.deed("stop", robot, reason=reason), make, reason)
            except SQLAlchemyError as error:
                allow_stop(caller.roles)
                log.exception("the emergency stop of %s is not stored", robot)
                self._outgoing.stop_unstored(robot, caller.name, reason, self._clock())
                told = f"the stop is sent, but not stored: {type(error).__name__}"
                raise SourceError(told, help="is the disk full, or the database away?") from None

    def release(self, caller: Caller, robot: str, request: ReleaseRequest) -> SettingsView:
        """End the emergency stop of a revision; RevisionError if that is not the newest."""

        def make(_session: Session, known: Known) -> Settings:
            allow_stop(caller.roles)
            if request.revision != known.row.revision:
                raise RevisionError(settings_view(known.row))
            return released(known.settings, request.reason)

        detail = {"revision": request.revision, "reason": request.reason}
        return self._revise(robot, caller.deed("stop.end", robot, **detail), make, request.reason)

    def _note_dry_run(self, session: Session, robot: str, hello: Hello) -> None:
        """Write once for each life of a guard that it forbids nothing."""
        if hello.dry_run and self._dry_runs.get(robot) != hello.run:
            deed = Deed(
                who=f"guard:{robot}", action="dry_run", target=robot, detail={"run": hello.run}
            )
            record_often(session, self._clock(), deed, "done")
            self._dry_runs[robot] = hello.run

    def _revise(self, robot: str, deed: Deed, make: _Make, reason: str) -> SettingsView:
        """Write what `make` makes of the newest settings; None if they are to stay as they are."""
        with self._outgoing.alone(robot), self._refusals(deed):
            self._store_unstored(robot)
            return _insisting(lambda: self._write(robot, deed, make, reason))

    def _write(self, robot: str, deed: Deed, make: _Make, reason: str) -> SettingsView:
        now = self._clock()
        with self._database.writing(durable=True) as session:
            known = find_known(session, robot)
            known = replace(known, settings=unexpired(last_good(session, known), now))
            made = make(session, known)
            row = known.row
            if made:
                row = add(session, known.app.id, made, Author(by=deed.who, reason=reason, at=now))
                if made.nodes != settings_of(known.row).nodes:
                    in_force = node_json(effective_plan(known.plan, made))
                    store_policy_settings(session, known.app.id, in_force)
                record(session, now, deed)
            else:
                record_often(session, now, deed, "done")
        view = settings_view(row)
        if made:
            self._outgoing.push(robot, made)
            self._outgoing.tell(robot, view)
        return view

    def _store_unstored(self, robot: str) -> None:
        """Store, above what was sent, the stop that went out although it could not be stored."""
        sent = self._outgoing.unstored(robot)
        if sent is None or sent.stop is None:
            return
        stop = sent.stop

        def make(_session: Session, known: Known) -> Settings:
            above = max(known.settings.revision, sent.revision) + 1
            return replace(known.settings, stop=stop, revision=above)

        deed = Deed(who=stop.by, action="stop", target=robot, detail={"reason": stop.reason})
        try:
            _insisting(lambda: self._write(robot, deed, make, stop.reason))
        except NotFoundError:
            self._outgoing.forget(robot)

    def _stop_alone(self, robot: str, refused: Settings) -> None:
        """Send a stop that was refused again, with what the guard last took, or with nothing."""
        deed = Deed(who=_SERVICE, action="stop", target=robot)

        def make(_session: Session, known: Known) -> Settings:
            last = known.settings
            nodes = {} if last.nodes == settings_of(known.row).nodes else last.nodes
            return replace(last, nodes=nodes, revision=last.revision + 1)

        with self._outgoing.alone(robot):
            with self._database.session() as session:
                row = find_known(session, robot).row
            if row.revision == refused.revision and refused.nodes:
                told = f"the guard refused revision {refused.revision}; the stop stays"
                self._revise(robot, deed, make, told)

    @contextmanager
    def _refusals(self, deed: Deed) -> Iterator[None]:
        """Write into the audit log why something is refused; without the log it is refused too."""
        try:
            yield
        except RTronError as error:
            with suppress(SQLAlchemyError), self._database.writing() as session:
                record_often(session, self._clock(), deed, f"refused: {error}")
            raise


def _insisting(attempt: Callable[[], _T]) -> _T:
    """Return what an attempt returns; as often as somebody else was faster, try again."""
    for _ in range(_MOST_TRIES):
        with suppress(IntegrityError):
            return attempt()
    raise ConflictError("too many change this at the same moment", help="try again")
