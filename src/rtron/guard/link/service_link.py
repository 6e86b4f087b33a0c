"""A guard with a security service: it tells events and its state, and takes settings."""

import logging
import time
from functools import partial
from typing import TYPE_CHECKING
from uuid import uuid4

from rtron import __version__
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.timers import DelayedCall
from rtron.guard.lanes.exchange.lane_state import LaneState, lane_state, stream_figures
from rtron.guard.link.event_recorder import EventCounter, EventRecorder, RecordEvent
from rtron.guard.link.host_events import HostEvents
from rtron.guard.link.link_client import LinkClient
from rtron.guard.link.options import LinkOptions
from rtron.guard.settings.in_force import SettingsInForce
from rtron.vocabulary import SECOND, EventKind, GuardEventLevel, GuardState, Plan, Settings
from rtron.wire.common.link_protocol import (
    Applied,
    CommandResponse,
    Hello,
    LeaseCommand,
    NewSettings,
    StateReport,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.lanes.bulk.command_connection import CommandConnection

log = logging.getLogger(__name__)

_STATE_PERIOD = SECOND // 5


class ServiceLink:
    """The guard's link to the service; the last settings are in force already."""

    def __init__(
        self,
        plan: Plan,
        host: Coordinator,
        settings: SettingsInForce,
        loop: EventLoop,
        options: LinkOptions,
        other_lane: "CommandConnection | None" = None,
    ) -> None:
        self._plan, self._host, self._settings, self._loop = plan, host, settings, loop
        self._other_lane = other_lane
        self._dry_run = any(guarded.dry_run for guarded in host.streams)
        self._run, self._began = uuid4().hex, time.time_ns()
        self._client = LinkClient(loop, options.address, self._hello, self._state, self._on_message)
        self.on_lease_command: Callable[[LeaseCommand], None] = lambda command: None
        """Takes what a person asks of a lease; `receive` takes the response."""
        self._recorder = EventRecorder(
            EventCounter(options.counter_folder, self._run),
            self._run,
            self._client.queue_event,
            lambda: self._client.has_capacity,
            time.time_ns,
        )
        self.record: RecordEvent = self._recorder.record
        self._recorder.revision = settings.revision
        self._host_events = HostEvents(host, self._recorder.record)
        self._schedule_state = DelayedCall(loop, _STATE_PERIOD, self._send_state).schedule
        self._host_events.on_change = self._schedule_state

    def open(self) -> None:
        """Tell what happens from now on; the host is open."""
        self._host_events.start()
        self._host_events.listen_to_alarms()
        if self._other_lane:
            self._other_lane.listen(self._recorder.record, self._schedule_state)
        self._recorder.record(EventKind.GUARD, reason="the guard begins", values=self._facts())
        if self._settings.refusal:
            self._record_settings(GuardEventLevel.ERROR, self._settings.refusal)
        self._client.open()
        self._record_counts()

    def close(self) -> None:
        """Tell that the guard ends in order."""
        self._recorder.record(EventKind.GUARD, reason="the guard ends")
        self._client.close()

    def receive(self, response: CommandResponse) -> None:
        """Pass on the response to what a person has asked of a lease."""
        self._client.send(response)

    def report_incident(self, name: str) -> None:
        """Tell that an incident was saved on this machine, in a file of this name."""
        reason, values = f"incident saved: {name}", {"incident": name}
        level = GuardEventLevel.WARNING
        self._recorder.record(EventKind.GUARD, level, reason=reason, values=values)

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
            settings=self._settings.current,
        )

    def _on_message(self, message: NewSettings | LeaseCommand) -> None:
        if isinstance(message, LeaseCommand):
            self.on_lease_command(message)
        else:
            self._apply(message.settings)

    def _apply(self, settings: Settings) -> None:
        """Put settings in force in every process of the guard, or in none."""
        if settings.revision < self._settings.revision:
            return
        if self._other_lane:
            self._other_lane.apply(settings, partial(self._on_lane_answer, settings))
        else:
            self._report_applied(settings, self._settings.apply(settings))

    def _on_lane_answer(self, settings: Settings, error: str) -> None:
        if error:
            self._settings.refuse(settings, error)
        else:
            error = self._settings.apply(settings)
        if error and self._other_lane:
            self._other_lane.apply(self._settings.current, _ignore_answer)
        self._report_applied(settings, error)

    def _report_applied(self, settings: Settings, error: str) -> None:
        self._recorder.revision = self._settings.revision
        self._client.send(Applied(revision=settings.revision, error=error))
        level = GuardEventLevel.ERROR if error else GuardEventLevel.INFO
        reason = error or f"revision {settings.revision} is in force"
        self._record_settings(level, reason, revision=settings.revision)
        if settings.stop and not self._is_stopped():
            warning = "the emergency stop stops nothing: this guard only observes"
            self._recorder.record(EventKind.STOP, GuardEventLevel.ERROR, reason=warning)
        self._schedule_state()

    def _record_settings(self, level: GuardEventLevel, reason: str, **values: int) -> None:
        self._recorder.record(EventKind.SETTINGS, level, reason=reason, **values)

    def _record_counts(self) -> None:
        """Tell, once a second, what became of the messages."""
        now = self._loop.now()
        self._loop.call_at(now + SECOND, self._record_counts)
        figures = stream_figures(self._host_events.stream_monitors.values(), now)
        if self._other_lane:
            figures |= self._other_lane.take_figures()
        if figures:
            values = {"streams": figures, "fps": self._fps(now)}
            self._recorder.record(EventKind.COUNTS, values=values)
        self._send_state()

    def _send_state(self) -> None:
        self._client.send(self._state())

    def _state(self) -> StateReport:
        now, mission = self._loop.now(), self._host.observations.mission
        known = mission.bits.known_values(now)
        lanes = self._lane_states(now)
        return StateReport(
            state=GuardState(
                at=time.time_ns(),
                revision=self._settings.revision,
                streams=tuple(stream for lane in lanes for stream in lane.streams),
                rules=tuple(rule for lane in lanes for rule in lane.rules),
                bits={name: known.get(name) for name in mission.bits.by_name},
                fps=self._fps(now),
                lost_events=self._host.lost_events(),
                alarms=self._host.alarms.active,
                overridden=tuple(id for lane in lanes for id in lane.overridden),
                stopped=self._is_stopped(),
            )
        )

    def _lane_states(self, now: int) -> list[LaneState]:
        monitors = self._host_events.stream_monitors.values()
        own = lane_state(self._host, monitors, now, stopped=self._settings.is_stopped)
        return [self._other_lane.state, own] if self._other_lane else [own]

    def _is_stopped(self) -> bool:
        return self._settings.is_stopped or bool(
            self._other_lane and self._other_lane.state.stopped
        )

    def _fps(self, now: int) -> dict[str, float]:
        monitors = self._host.observations.rates.monitors
        return {name: monitor.rate(now).fps for name, monitor in monitors.items()}


def _ignore_answer(_error: str) -> None:
    """Do nothing about an answer."""
