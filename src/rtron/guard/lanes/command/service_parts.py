"""What follows the security service in the command process; most guards load none of it."""

import logging
from functools import partial

from rtron.errors import SourceError
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.service_leases import ServiceLeases
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import BackgroundWorker, EventLoop
from rtron.guard.lanes.assignment import command_part
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.lanes.command.service_reports import ServiceReports
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.settings_file import read_settings
from rtron.guard.runner import Part
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.settings.saved_settings import settings_at_start
from rtron.guard.system.machine_time import machine_time
from rtron.guard.transport.common.protocol import LiveTransport
from rtron.vocabulary import EmergencyStop, Plan, Settings
from rtron.wire.common.link_protocol import LeaseCommand

log = logging.getLogger(__name__)

_PERIOD_S = 0.1


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
    connection.on_settings = reports.apply
    _follow_leases(connection, ServiceLeases(leases, reports.record))
    return [reports, SavedStop(settings, link, loop)]


def _follow_leases(connection: BulkConnection, leases: ServiceLeases) -> None:
    """Do what persons at the service ask of leases, and answer."""

    def receive(message: object) -> None:
        if isinstance(message, LeaseCommand):
            connection.send(leases.carry_out(message))

    connection.message_listeners.append(receive)


class SavedStop:
    """Looks at the settings file ten times a second; puts a stop in force, and nothing else.

    Settings come by the bulk process, which may be away, hang or be busy with pictures.

    A stop is released by settings that come on the usual way. A disk that is full keeps no stop,
    and one that hangs keeps this look waiting and no command.
    """

    def __init__(self, settings: SettingsInForce, options: LinkOptions, loop: EventLoop) -> None:
        self._settings = settings
        self._file = options.settings_file
        self._loop = loop
        self._worker = BackgroundWorker(self._look, "saved-stop")
        self._read_at = 0
        self._failure = ""
        self._is_closed = False

    def open(self) -> None:
        """Look from now on."""
        if not self._is_closed:
            self._loop.call_later(_PERIOD_S, self.open)
            self._worker.request()

    def close(self) -> None:
        """Look no more."""
        self._is_closed = True

    def _look(self) -> None:
        """Read the file if it has changed, in the worker's thread."""
        try:
            written_at = self._file.stat().st_mtime_ns
        except OSError:
            return  # nothing was kept
        if written_at == self._read_at:
            return
        try:
            saved = read_settings(self._file, machine_time())
        except SourceError as error:  # not at the start: what is in force is known
            self._log_once(str(error))
            return
        self._read_at, self._failure = written_at, ""
        if saved and saved.stop:
            self._loop.post(partial(self._stop, saved, saved.stop))

    def _log_once(self, failure: str) -> None:
        """Say why the file cannot be read, which is tried again at the next look."""
        if failure != self._failure:
            log.error("%s", failure)
        self._failure = failure

    def _stop(self, saved: Settings, stop: EmergencyStop) -> None:
        if saved.revision > self._settings.revision:
            self._settings.stop_robot(stop)
