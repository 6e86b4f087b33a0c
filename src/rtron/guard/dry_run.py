"""The guard as a dry run: one process, which forwards everything and reports what it would do."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.authority.latched_stops import LatchedStops
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.lease_topics import LeaseTopics
from rtron.guard.authority.service_leases import ServiceLeases
from rtron.guard.cell.access import GUARD
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import UnreadableInputAlarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.lanes.bulk.command_nodes import CommandNodes
from rtron.guard.lanes.exchange.process_connection import ProcessConnection
from rtron.guard.link.service_link import ServiceLink
from rtron.guard.measurement.run import RunMeasurement, WriteFigures
from rtron.guard.middleware import open_middleware
from rtron.guard.runner import (
    INTERRUPTS,
    GraphPart,
    Part,
    open_control_socket,
    run_parts,
)
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.settings.intrusion_clearing import create_request_handler
from rtron.guard.settings.saved_settings import settings_at_start
from rtron.guard.supervision.delivery_watch import DeliveryEcho
from rtron.guard.system.process_attributes import allow_many_files
from rtron.vocabulary import Plan, build_streams

if TYPE_CHECKING:
    from pathlib import Path

    from rtron.guard.link.options import LinkOptions
    from rtron.guard.supervision.supervisor_client import SupervisorClient


def run_dry(
    plan: Plan,
    master: str,
    supervisor: SupervisorClient,
    *,
    control: Path | None = None,
    figures: WriteFigures | None = None,
    link: LinkOptions | None = None,
) -> None:
    """Observe a plan's streams on the master or in the domain at `master`, until stopped.

    `control` is the socket for overrides, by default in the user's runtime folder. `figures` writes
    what is measured. `link` leads to the security service. SourceError if the plan is for ROS 2,
    which is not installed here, or if `control` cannot be used.
    """
    allow_many_files()
    loop = EventLoop()
    middleware = open_middleware(plan, master, loop, supervisor.session, GUARD)
    transport = middleware.transport
    measuring = RunMeasurement(plan, transport) if figures else None
    observations = measuring.observations if measuring else observations_of(plan)
    coordinator = Coordinator(
        transport,
        build_streams(plan),
        observations,
        dry_run=True,
        handover=supervisor.handover_state,
    )
    parts: list[Part] = [GraphPart(coordinator.open, transport), DeliveryEcho(transport)]
    leases = LeaseController(coordinator, transport)
    if link:
        settings = SettingsInForce(SettingsApplier(plan, coordinator, transport))
        settings_at_start(settings, link)
        parts.append(_service_link(ServiceLink(plan, coordinator, settings, loop, link), leases))
    response = AlarmResponse(coordinator, transport, plan.audit.on_foreign, dry_run=True)
    no_others = CommandNodes(ProcessConnection(loop), loop, frozenset())
    parts.append(middleware.create_auditor(response, no_others))
    supervisor.attach(loop, coordinator)
    transport.set_unreadable_handler(UnreadableInputAlarms(coordinator.alarms, transport).report)
    parts.append(LeaseTopics(leases, transport))
    stops = LatchedStops(coordinator, transport, plan)
    handler = create_request_handler(coordinator, transport, leases, stops)
    if socket := open_control_socket(loop, plan, control, handler):
        parts.append(socket)
    if measuring and figures:
        measuring.measure(coordinator.streams)
        measuring.write_periodically(figures)
    run_parts(loop, [*parts, supervisor], until=INTERRUPTS)
    if measuring and figures:
        figures(measuring.figures())


def _service_link(link: ServiceLink, controller: LeaseController) -> ServiceLink:
    """Let persons at the service say who is in command, as far as a dry run goes."""
    leases = ServiceLeases(controller, link.record)
    link.on_lease_command = lambda command: link.receive(leases.carry_out(command))
    return link
