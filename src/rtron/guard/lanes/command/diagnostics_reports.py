"""What the command process tells the bulk process for the diagnostics."""

import logging

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.diagnostics import alarm_statuses
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.report_messages import ERROR, Status
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.vocabulary import SECOND, Alarm

log = logging.getLogger(__name__)

_NOT_CONNECTED = Status(
    ERROR,
    "rtron: bulk process",
    "not connected: frame rates and events are not known, states do not pass, "
    "nobody looks for intruders",
    {},
)


class DiagnosticsReports:
    """Tells the state of the streams once a second, and what changes at once."""

    def __init__(
        self,
        connection: BulkConnection,
        host: Coordinator,
        loop: EventLoop,
        topics: int,
    ) -> None:
        """`topics` is how many the guard has in all of its processes."""
        self._connection = connection
        self._host = host
        self._loop = loop
        self._topics = topics
        self._has_connected = False
        connection.connect_listeners.append(self._on_connect)

    def open(self) -> None:
        """Report from now on."""
        self._host.alarms.listener = self._send_alarm
        self._report_periodically()

    def close(self) -> None:
        """Report no more; the connection ends with the process."""

    def _report_periodically(self) -> None:
        self._loop.call_at(self._loop.now() + SECOND, self._report_periodically)
        self._report()

    def _report(self) -> None:
        statuses = tuple(self._host.stream_statuses())
        if not self._connection.is_connected:
            alarms = alarm_statuses(self._host.alarms, self._loop.now())
            self._host.publish_diagnostics([_NOT_CONNECTED, *statuses, *alarms])
        else:
            self._connection.call("statuses", statuses)

    def _on_connect(self) -> None:
        if not self._has_connected:
            self._has_connected = True
            log.info("guarding %d topics", self._topics)
        self._report()
        for alarm in self._host.alarms.active:
            self._send_alarm(alarm, active=True)

    def _send_alarm(self, alarm: Alarm, *, active: bool) -> None:
        self._connection.call("alarm", alarm, active)
