"""The risk controller (paper section 6.3): people's settings, checked, kept, sent to the guards.

What was answered is in the database before. Each change is one new revision, and whoever was
overtaken has to look again; the emergency stop is not overtaken: it goes on top of the newest.
"""

import json
import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any, Protocol, TypeVar

from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from rtron.errors import RTronError, SourceError
from rtron.service.api.credentials import Caller
from rtron.service.api.models import (
    OverrideRequest,
    SettingsChange,
    SettingsOutcome,
    SettingsView,
)
from rtron.service.clock import Clock
from rtron.service.controller.changing import (
    RevisionError,
    allow_override,
    allow_stop,
    changed,
    in_force_again,
    overridden,
    released,
    stopped,
)
from rtron.service.controller.greetings import greeted
from rtron.service.controller.known import (
    Known,
    find_current_app,
    find_known,
    last_good,
    unexpired,
)
from rtron.service.controller.risk_model import node_json
from rtron.service.errors import ConflictError
from rtron.service.store.audit import Deed, record
from rtron.service.store.database import Database
from rtron.service.store.robots import store_policy_settings
from rtron.service.store.settings_rows import (
    Author,
    add,
    answer,
    revision,
    settings_of,
    settings_view,
)
from rtron.vocabulary import Settings, effective
from rtron.wire.link import Applied, Hello

log = logging.getLogger(__name__)
_MOST_TRIES = 100
_LONGEST_DETAIL = 2000
_SERVICE = "rtron"
_T = TypeVar("_T")
_Make = Callable[[Session, Known], Settings | None]


class Guards(Protocol):
    """What the controller needs of the hub: the way to the guards, and to those who watch."""

    def push(self, robot: str, settings: Settings) -> None:
        """Send settings to the robot's guard, if it is connected."""

    def tell(self, live: dict[str, Any]) -> None:
        """Tell everybody who watches."""


class Controller:
    """Keeps the settings of every robot. All methods may be called from any thread.

    They raise NotFoundError for a robot or node that is not known, ForbiddenError where the
    caller's roles do not suffice, InputError for what makes no plan. Every attempt, and what came
    of it, stands in the audit log.
    """

    def __init__(self, database: Database, hub: Guards, clock: Clock) -> None:
        self._database = database
        self._hub = hub
        self._clock = clock
        self._sent: dict[str, Settings] = {}
        self._unstored: dict[str, Settings] = {}
        self._dry_runs: dict[str, str] = {}

    def greet(self, robot: str, hello: Hello) -> Settings:
        """Store a guard's app, plan and coordination nodes; return what it is to put in force.

        Settings that no longer fit the plan are left out, as a new revision.
        """

        def store() -> Settings:
            with self._database.writing() as session:
                found = greeted(session, robot, hello, self._clock())
                self._note_dry_run(session, robot, hello)
            if found.is_new:
                self._tell(robot, settings_view(found.row))
            return found.settings

        settings = self._above_unstored(robot, _insisting(store))
        self._sent[robot] = settings
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
                record(session, now, _answer(robot, applied), outcome.value)
            settings, view = settings_of(row), settings_view(row)
        if is_new:
            self._tell(robot, view)
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
            nodes=_short(change.nodes),
            reason=change.reason,
        )

        def make(_session: Session, known: Known) -> Settings | None:
            if change.revision != known.row.revision:
                raise RevisionError(settings_view(known.row))
            after = changed(known.plan, known.settings, caller.roles, change)
            return after if after.nodes != known.settings.nodes else None

        return self._revise(robot, deed, make, change.reason)

    def override(
        self, caller: Caller, robot: str, node: str, request: OverrideRequest
    ) -> SettingsView:
        """Let pass for a while what a coordination node forbids."""
        deed = caller.deed(
            "override", _place(robot, node), duration=request.duration, reason=request.reason
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

        return self._revise(robot, caller.deed("override.end", _place(robot, node)), make, "")

    def stop(self, caller: Caller, robot: str, reason: str) -> SettingsView:
        """Stop a robot until it is released; a second stop goes out unless the first is in force.

        Where the database does not take it, it goes out all the same, and SourceError tells.
        """

        def make(session: Session, known: Known) -> Settings | None:
            allow_stop(caller.roles)
            confirmed = known.row.outcome == SettingsOutcome.APPLIED
            if confirmed and settings_of(known.row).stop:
                return None
            return stopped(last_good(session, known), caller.name, reason, self._clock())

        try:
            return self._revise(robot, caller.deed("stop", robot, reason=reason), make, reason)
        except SQLAlchemyError as error:
            allow_stop(caller.roles)
            log.exception("the emergency stop of %s is not stored", robot)
            self._stop_unstored(caller, robot, reason)
            told = f"the stop is sent, but not stored: {type(error).__name__}"
            raise SourceError(told, help="is the disk full, or the database away?") from None

    def release(self, caller: Caller, robot: str, reason: str) -> SettingsView:
        """End an emergency stop; it takes a reason."""

        def make(_session: Session, known: Known) -> Settings:
            allow_stop(caller.roles)
            return released(known.settings, reason)

        deed = caller.deed("stop.end", robot, reason=reason)
        return self._revise(robot, deed, make, reason)

    def _note_dry_run(self, session: Session, robot: str, hello: Hello) -> None:
        """Write once for each life of a guard that it forbids nothing."""
        if hello.dry_run and self._dry_runs.get(robot) != hello.run:
            deed = Deed(who=f"guard:{robot}", action="dry_run", target=robot)
            record(session, self._clock(), deed)
            self._dry_runs[robot] = hello.run

    def _revise(self, robot: str, deed: Deed, make: _Make, reason: str) -> SettingsView:
        """Write what `make` makes of the newest settings; None if they are to stay as they are."""
        with self._refusals(deed):
            return _insisting(lambda: self._write(robot, deed, make, reason))

    def _write(self, robot: str, deed: Deed, make: _Make, reason: str) -> SettingsView:
        now = self._clock()
        with self._database.writing() as session:
            known = self._known(session, robot, now)
            made = make(session, known)
            row = known.row
            if made:
                row = add(session, known.app.id, made, Author(by=deed.who, reason=reason, at=now))
                if made.nodes != known.settings.nodes:
                    in_force = node_json(effective(known.plan, made))
                    store_policy_settings(session, known.app.id, in_force)
            record(session, now, deed)
        view = settings_view(row)
        if made:
            self._hub.push(robot, made)
            self._sent[robot] = made
            self._unstored.pop(robot, None)
            self._tell(robot, view)
        return view

    def _known(self, session: Session, robot: str, now: int) -> Known:
        known = find_known(session, robot)
        settings = self._above_unstored(robot, unexpired(known.settings, now))
        return replace(known, settings=settings)

    def _above_unstored(self, robot: str, settings: Settings) -> Settings:
        """Return settings with the stop that went out although it could not be stored."""
        unstored = self._unstored.get(robot)
        if unstored is None or unstored.revision < settings.revision:
            return settings
        return replace(settings, revision=unstored.revision, stop=unstored.stop)

    def _stop_unstored(self, caller: Caller, robot: str, reason: str) -> None:
        """Send a stop on top of what was last sent, to be stored with what comes next."""
        before = self._unstored.get(robot) or self._sent.get(robot, Settings())
        settings = stopped(before, caller.name, reason, self._clock())
        self._unstored[robot] = settings
        self._hub.push(robot, settings)

    def _stop_alone(self, robot: str, refused: Settings) -> None:
        """Send a stop that was refused again, with what the guard last took, or with nothing."""
        deed = Deed(who=_SERVICE, action="stop", target=robot)

        def make(session: Session, known: Known) -> Settings:
            last = last_good(session, known)
            nodes = {} if last.nodes == known.settings.nodes else last.nodes
            return replace(known.settings, nodes=nodes, revision=known.settings.revision + 1)

        with self._database.writing() as session:
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
                record(session, self._clock(), deed, f"refused: {error}")
            raise

    def _tell(self, robot: str, view: SettingsView) -> None:
        live = {"type": "settings", "robot": robot, "view": view.model_dump(mode="json")}
        self._hub.tell(live)


def _insisting(attempt: Callable[[], _T]) -> _T:
    """Return what an attempt returns; as often as somebody else was faster, try again."""
    for _ in range(_MOST_TRIES):
        with suppress(IntegrityError):
            return attempt()
    raise ConflictError("too many change this at the same moment", help="try again")


def _answer(robot: str, applied: Applied) -> Deed:
    detail = {"revision": applied.revision, "error": applied.error[:_LONGEST_DETAIL]}
    return Deed(who=f"guard:{robot}", action="settings.answer", target=robot, detail=detail)


def _short(nodes: Mapping[str, Any]) -> str:
    return json.dumps(nodes)[:_LONGEST_DETAIL]


def _place(robot: str, node: str) -> str:
    return f"{robot}/{node}"
