"""What follows the security service in the command process; most guards load none of it."""

from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.service_leases import ServiceLeases
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.assignment import command_part
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.lanes.command.service_reports import ServiceReports
from rtron.guard.link.options import LinkOptions
from rtron.guard.runner import Part
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.settings.saved_settings import settings_at_start
from rtron.guard.settings.saved_stop import SavedStop
from rtron.guard.transport.common.protocol import LiveTransport
from rtron.vocabulary import Plan
from rtron.wire.common.link_protocol import LeaseCommand


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
