"""What follows the security service in the command process; most guards load none of it."""

import time
from collections import deque
from typing import Any

from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.service_leases import ServiceLeases
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.timers import DelayedCall
from rtron.guard.lanes.assignment import command_part
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.lanes.exchange.lane_state import lane_state, stream_figures
from rtron.guard.link.host_events import HostEvents
from rtron.guard.link.options import LinkOptions
from rtron.guard.runner import Part
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.settings.saved_settings import SavedStop, settings_at_start
from rtron.guard.transport.common.protocol import LiveTransport
from rtron.vocabulary import SECOND, EventKind, GuardEventLevel, Plan, Settings

_STATE_PERIOD = SECOND // 5
MAX_PENDING_EVENTS = 20_000
_EVENTS_AT_ONCE = 20
_SEND_PERIOD = SECOND // 100
"""So that a command waits for some 20 events at most, about 1 ms."""


def service_parts(
    plan: Plan,
    leases: LeaseController,
    coordinator: Coordinator,
    transport: LiveTransport,
    connection: BulkConnection,
    loop: EventLoop,
    link: LinkOptions,
) -> list[Part]:
    """Put the service's last settings in force; return what follows the service from then on."""
    settings = SettingsInForce(SettingsApplier(plan, coordinator, transport, command_part))
    settings_at_start(settings, link)
    reports = ServiceReports(connection, coordinator, loop, settings)
    service_leases = ServiceLeases(leases, reports.record)
    connection.on(
        apply_settings=reports.apply,
        lease_command=lambda each: connection.call(
            "lease_response", service_leases.carry_out(each)
        ),
    )
    return [reports, SavedStop(settings, link, loop)]


class ServiceReports:
    """Tells what happens to the streams, for the security service."""

    def __init__(
        self,
        connection: BulkConnection,
        host: Coordinator,
        loop: EventLoop,
        settings: SettingsInForce,
    ) -> None:
        self._connection = connection
        self._host = host
        self._loop = loop
        self._settings = settings
        self._unsent: deque[tuple[int, EventKind, GuardEventLevel, dict[str, Any]]] = deque()
        self._events = HostEvents(host, self.record)
        self._events.on_change = DelayedCall(loop, _STATE_PERIOD, self._send_state).schedule
        self._is_sending_due = False
        self._lost_count = 0
        connection.connect_listeners.append(self._on_connect)

    def open(self) -> None:
        """Report from now on."""
        self._events.start()
        self._report_periodically()

    def close(self) -> None:
        """Report no more; the connection ends with the process."""

    def apply(self, settings: Settings) -> None:
        """Put settings in force, and answer."""
        error = self._settings.apply(settings)
        self._connection.call("settings_answer", settings.revision, error)
        self._events.on_change()

    def record(
        self,
        kind: EventKind,
        level: GuardEventLevel = GuardEventLevel.INFO,
        **values: Any,  # noqa: ANN401
    ) -> None:
        """Tell an event, or count it as lost if too many wait."""
        if len(self._unsent) == MAX_PENDING_EVENTS:
            self._lost_count += 1
            return
        if self._lost_count and len(self._unsent) < MAX_PENDING_EVENTS - 1:
            self._record_lost()
        self._unsent.append((time.time_ns(), kind, level, values))
        if not self._is_sending_due:
            self._send_events()

    def _report_periodically(self) -> None:
        now = self._loop.now()
        self._loop.call_at(now + SECOND, self._report_periodically)
        figures = stream_figures(self._events.stream_monitors.values(), now)
        self._connection.call("figures", figures)
        self._send_state()

    def _record_lost(self) -> None:
        count, self._lost_count = self._lost_count, 0
        reason = f"{count} events were lost: the bulk process was away for too long"
        values = {"reason": reason, "values": {"events": count}}
        level = GuardEventLevel.WARNING
        self._unsent.append((time.time_ns(), EventKind.LOST, level, values))

    def _on_connect(self) -> None:
        self._send_events()
        self._send_state()

    def _send_events(self) -> None:
        """Tell some of the events that wait for a bulk process, and the others a little later."""
        for _ in range(_EVENTS_AT_ONCE):
            if not self._unsent or not self._connection.is_ready:
                break
            self._connection.call("event", *self._unsent.popleft())
        if self._unsent and self._connection.is_connected and not self._is_sending_due:
            self._is_sending_due = True
            self._loop.call_at(self._loop.now() + _SEND_PERIOD, self._send_more_events)

    def _send_more_events(self) -> None:
        self._is_sending_due = False
        self._send_events()

    def _send_state(self) -> None:
        now = self._loop.now()
        monitors = self._events.stream_monitors.values()
        stopped = self._settings.is_stopped
        state = lane_state(self._host, monitors, now, stopped=stopped)
        self._connection.call("state", state)
