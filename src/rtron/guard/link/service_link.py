"""A guard with a security service: it tells events and its state, and takes settings."""

import logging
import time
from dataclasses import replace
from uuid import uuid4

from rtron import __version__
from rtron.errors import InputError, RTronError
from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.link.event_counter import RunCounter
from rtron.guard.link.event_recorder import Recorder
from rtron.guard.link.link_client import Line
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings
from rtron.guard.settings.applier import Applying
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import (
    SECOND,
    EventKind,
    GuardState,
    Level,
    MisfitError,
    Plan,
    RuleState,
    Settings,
)
from rtron.wire.common.link_protocol import Applied, Hello, NewSettings, State

log = logging.getLogger(__name__)

_AT_MOST_EACH = SECOND // 5


class Linked:
    """Puts the last settings in force before the guard opens, and is its link from then on."""

    def __init__(
        self, plan: Plan, host: Host, transport: Transport, loop: Loop, options: LinkOptions
    ) -> None:
        _prepare(options)
        self._plan, self._host, self._transport, self._loop = plan, host, transport, loop
        self._dry_run = any(guarded.dry_run for guarded in host.guarded)
        self._run, self._began = uuid4().hex, time.time_ns()
        self._applying = Applying(plan, host, transport)
        self._line = Line(loop, options.address, self._hello, self._state, self._new_settings)
        counter = RunCounter(options.runs, self._run)
        self._recorder = Recorder(
            host, counter, self._run, self._line.tell, lambda: self._line.has_place, time.time_ns
        )
        self._recorder.changed = self._changed
        self._told_at = 0
        self._telling = False
        self._refused = ""
        self._in_force = Settings(revision=plan.revision)
        kept = read_settings(options.settings_file, time.time_ns())
        if kept:
            self._apply(kept)

    def open(self) -> None:
        """Tell what happens from now on; the host is open."""
        self._recorder.watch()
        self._recorder.record(EventKind.GUARD, reason="the guard begins", values=self._facts())
        if self._refused:
            self._recorder.record(EventKind.SETTINGS, Level.ERROR, reason=self._refused)
        self._line.open()
        self._count()

    def close(self) -> None:
        """Tell that the guard ends in order."""
        self._recorder.record(EventKind.GUARD, reason="the guard ends")
        self._line.close()

    def _facts(self) -> dict[str, object]:
        return {"app": self._plan.app, "version": __version__, "dry_run": self._dry_run}

    def _hello(self) -> Hello:
        return Hello(
            app=self._plan.app,
            plan=self._plan,
            run=self._run,
            began=self._began,
            version=__version__,
            dry_run=self._dry_run,
            settings=self._in_force,
        )

    def _new_settings(self, message: NewSettings) -> None:
        settings = message.settings
        if settings.revision < self._applying.revision:
            return
        error = self._apply(settings)
        self._line.say(Applied(revision=settings.revision, error=error))
        level = Level.ERROR if error else Level.INFO
        reason = error or f"revision {settings.revision} is in force"
        self._recorder.record(EventKind.SETTINGS, level, reason=reason, revision=settings.revision)
        if settings.stop and not self._applying.stopped:
            told = "the emergency stop stops nothing: this guard only observes"
            self._recorder.record(EventKind.STOP, Level.ERROR, reason=told)
        self._changed()

    def _apply(self, settings: Settings) -> str:
        """Put settings in force; return why that is not possible, or nothing."""
        try:
            self._applying.apply(settings, time.time_ns())
        except (RTronError, MisfitError) as error:
            self._refused = f"revision {settings.revision} is refused: {error}"
            log.error("settings: %s", self._refused)  # noqa: TRY400 - it tells enough
            self._stop_all_the_same(settings)
            return str(error)
        self._recorder.revision = settings.revision
        self._in_force = settings
        log.info("settings: revision %d is in force", settings.revision)
        return ""

    def _stop_all_the_same(self, settings: Settings) -> None:
        """Stop the robot for what else is in settings that are refused: beside what is in force."""
        if settings.stop:
            self._in_force = replace(self._in_force, stop=settings.stop)
            self._applying.apply(self._in_force, time.time_ns())

    def _count(self) -> None:
        """Tell, once a second, what became of the messages."""
        now = self._loop.now()
        self._loop.call_at(now + SECOND, self._count)
        figures = {
            watch.guarded.stream.topic: found
            for watch in self._recorder.watches.values()
            if (found := watch.figures(now))
        }
        if figures:
            values = {"streams": figures, "fps": self._fps(now)}
            self._recorder.record(EventKind.COUNTS, values=values)
        self._tell_state()

    def _changed(self) -> None:
        """Tell the state soon; what flickers is told a few times a second."""
        if not self._telling:
            self._telling = True
            due = max(self._loop.now(), self._told_at + _AT_MOST_EACH)
            self._loop.call_at(due, self._tell_state)

    def _tell_state(self) -> None:
        self._telling = False
        self._told_at = self._loop.now()
        self._line.say(self._state())

    def _state(self) -> State:
        now, senses = self._loop.now(), self._host.senses
        standings = senses.mission.standings.values()
        known = senses.mission.bits.known(now)
        return State(
            state=GuardState(
                at=time.time_ns(),
                revision=self._applying.revision,
                streams=tuple(watch.state(now) for watch in self._recorder.watches.values()),
                rules=tuple(
                    RuleState(name=each.rule.name, blocks=each.blocks, reason=each.reason)
                    for each in standings
                ),
                bits={name: known.get(name) for name in senses.mission.bits.named},
                fps=self._fps(now),
                alarms=self._host.alarms.standing,
                overridden=tuple(self._overridden(now)),
                stopped=self._applying.stopped,
            )
        )

    def _fps(self, now: int) -> dict[str, float]:
        monitors = self._host.senses.rates.monitors
        return {name: monitor.rate(now).fps for name, monitor in monitors.items()}

    def _overridden(self, now: int) -> dict[str, None]:
        return {
            id: None
            for guarded in self._host.guarded
            for id, policy in guarded.overridable.items()
            if policy.override and now < policy.override.until
        }


def _prepare(options: LinkOptions) -> None:
    """Make the folders; a guard whose disk is full guards all the same."""
    try:
        options.prepare()
    except InputError as error:
        log.error("the link to the service will not work: %s", error)  # noqa: TRY400
