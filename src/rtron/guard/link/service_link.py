"""A guard with a security service: it tells events and its state, and takes settings."""

import logging
import time
from dataclasses import replace
from uuid import uuid4

from rtron import __version__
from rtron.errors import InputError, RTronError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.event_counter import EventCounter
from rtron.guard.link.event_recorder import EventRecorder
from rtron.guard.link.link_client import LinkClient
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import (
    SECOND,
    EventKind,
    GuardEventLevel,
    GuardState,
    Plan,
    RuleState,
    Settings,
)
from rtron.wire.common.link_protocol import Applied, Hello, NewSettings, StateReport

log = logging.getLogger(__name__)

_STATE_PERIOD = SECOND // 5


class ServiceLink:
    """Puts the last settings in force before the guard opens, and is its link from then on."""

    def __init__(
        self,
        plan: Plan,
        host: Coordinator,
        transport: Transport,
        loop: EventLoop,
        options: LinkOptions,
    ) -> None:
        _prepare_folders(options)
        self._plan, self._host, self._transport, self._loop = plan, host, transport, loop
        self._dry_run = any(guarded.dry_run for guarded in host.streams)
        self._run, self._began = uuid4().hex, time.time_ns()
        self._applying = SettingsApplier(plan, host, transport)
        self._client = LinkClient(
            loop, options.address, self._hello, self._state, self._on_settings
        )
        counter = EventCounter(options.counter_folder, self._run)
        self._recorder = EventRecorder(
            host,
            counter,
            self._run,
            self._client.queue_event,
            lambda: self._client.has_capacity,
            time.time_ns,
        )
        self._recorder.on_change = self._schedule_state
        self._state_sent_at = 0
        self._is_state_due = False
        self._refusal = ""
        self._in_force = Settings(revision=plan.revision)
        saved = read_settings(options.settings_file, time.time_ns())
        if saved:
            self._apply(saved)

    def open(self) -> None:
        """Tell what happens from now on; the host is open."""
        self._recorder.start()
        self._recorder.record(EventKind.GUARD, reason="the guard begins", values=self._facts())
        if self._refusal:
            self._recorder.record(EventKind.SETTINGS, GuardEventLevel.ERROR, reason=self._refusal)
        self._client.open()
        self._record_counts()

    def close(self) -> None:
        """Tell that the guard ends in order."""
        self._recorder.record(EventKind.GUARD, reason="the guard ends")
        self._client.close()

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

    def _on_settings(self, message: NewSettings) -> None:
        settings = message.settings
        if settings.revision < self._applying.revision:
            return
        error = self._apply(settings)
        self._client.send(Applied(revision=settings.revision, error=error))
        level = GuardEventLevel.ERROR if error else GuardEventLevel.INFO
        reason = error or f"revision {settings.revision} is in force"
        self._recorder.record(EventKind.SETTINGS, level, reason=reason, revision=settings.revision)
        if settings.stop and not self._applying.is_stopped:
            warning = "the emergency stop stops nothing: this guard only observes"
            self._recorder.record(EventKind.STOP, GuardEventLevel.ERROR, reason=warning)
        self._schedule_state()

    def _apply(self, settings: Settings) -> str:
        """Put settings in force; return why that is not possible, or nothing."""
        try:
            self._applying.apply(settings, time.time_ns())
        except RTronError as error:
            self._refusal = f"revision {settings.revision} is refused: {error}"
            log.error("settings: %s", self._refusal)  # noqa: TRY400 - it tells enough
            self._apply_stop_only(settings)
            return str(error)
        self._recorder.revision = settings.revision
        self._in_force = settings
        log.info("settings: revision %d is in force", settings.revision)
        return ""

    def _apply_stop_only(self, settings: Settings) -> None:
        """Stop the robot for what else is in settings that are refused: beside what is in force."""
        if settings.stop:
            self._in_force = replace(self._in_force, stop=settings.stop)
            self._applying.apply(self._in_force, time.time_ns())

    def _record_counts(self) -> None:
        """Tell, once a second, what became of the messages."""
        now = self._loop.now()
        self._loop.call_at(now + SECOND, self._record_counts)
        figures = {
            watch.guarded.spec.topic: found
            for watch in self._recorder.stream_monitors.values()
            if (found := watch.figures(now))
        }
        if figures:
            values = {"streams": figures, "fps": self._fps(now)}
            self._recorder.record(EventKind.COUNTS, values=values)
        self._send_state()

    def _schedule_state(self) -> None:
        """Tell the state soon; what flickers is told a few times a second."""
        if not self._is_state_due:
            self._is_state_due = True
            due = max(self._loop.now(), self._state_sent_at + _STATE_PERIOD)
            self._loop.call_at(due, self._send_state)

    def _send_state(self) -> None:
        self._is_state_due = False
        self._state_sent_at = self._loop.now()
        self._client.send(self._state())

    def _state(self) -> StateReport:
        now, observations = self._loop.now(), self._host.observations
        statuses = observations.mission.statuses.values()
        known = observations.mission.bits.known_values(now)
        return StateReport(
            state=GuardState(
                at=time.time_ns(),
                revision=self._applying.revision,
                streams=tuple(
                    watch.state(now) for watch in self._recorder.stream_monitors.values()
                ),
                rules=tuple(
                    RuleState(name=each.rule.name, blocks=each.is_blocking, reason=each.reason)
                    for each in statuses
                ),
                bits={name: known.get(name) for name in observations.mission.bits.by_name},
                fps=self._fps(now),
                alarms=self._host.alarms.active,
                overridden=tuple(self._overridden(now)),
                stopped=self._applying.is_stopped,
            )
        )

    def _fps(self, now: int) -> dict[str, float]:
        monitors = self._host.observations.rates.monitors
        return {name: monitor.rate(now).fps for name, monitor in monitors.items()}

    def _overridden(self, now: int) -> dict[str, None]:
        return {
            id: None
            for guarded in self._host.streams
            for id, policy in guarded.override_policies.items()
            if policy.active_override and now < policy.active_override.until
        }


def _prepare_folders(options: LinkOptions) -> None:
    """Make the folders; a guard whose disk is full guards all the same."""
    try:
        options.prepare()
    except InputError as error:
        log.error("the link to the service will not work: %s", error)  # noqa: TRY400
