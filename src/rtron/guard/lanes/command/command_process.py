"""The command process: it carries what can move the robot, and stops it for the audit."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.authority.latched_stops import LatchedStops, stop_file
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.authority.lease_topics import LeaseTopics
from rtron.guard.authority.stop_buttons import StopButtons
from rtron.guard.cell.access import GUARD
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import UnreadableInputAlarms
from rtron.guard.core.control_socket import control_path
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState, HeartbeatFile, heartbeat_path
from rtron.guard.incidents.stream_notes import IncidentNotes
from rtron.guard.intrusion_latch import intrusion_file
from rtron.guard.lanes.assignment import bulk_part, command_part
from rtron.guard.lanes.command.audit_watchdog import AuditWatchdog
from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.lanes.command.diagnostics_reports import DiagnosticsReports
from rtron.guard.lanes.command.node_reports import NodeReports
from rtron.guard.lanes.command.remote_audit import RemoteAudit, RemoteBrake
from rtron.guard.middleware import open_middleware
from rtron.guard.rehearsal import Rehearsal
from rtron.guard.runner import (
    GraphPart,
    Part,
    open_control_socket,
    run_parts,
)
from rtron.guard.settings.intrusion_clearing import create_request_handler
from rtron.guard.supervision.delivery_watch import DeliveryEcho
from rtron.guard.supervision.output_watch import OutputWatch
from rtron.guard.system.process_attributes import allow_many_files
from rtron.vocabulary import Mode, OnForeign, Plan, build_streams

if TYPE_CHECKING:
    from pathlib import Path

    from rtron.guard.core.control_socket import RequestHandler
    from rtron.guard.link.options import LinkOptions
    from rtron.guard.supervision.supervisor_client import SupervisorClient
    from rtron.guard.transport.common.protocol import LiveTransport

log = logging.getLogger(__name__)


def run_command_process(
    plan: Plan,
    master: str,
    supervisor: SupervisorClient,
    *,
    control: Path | None = None,
    link: LinkOptions | None = None,
) -> None:
    """Carry what can move the robot, at a ROS 1 master or in a ROS 2 domain, until stopped.

    `control` is the socket for overrides, by default in the user's runtime folder. The last
    settings of the security service at `link` are put in force first. SourceError if the plan is
    for ROS 2, which is not installed here, or if `control` cannot be used.
    """
    allow_many_files()
    loop = EventLoop()
    middleware = open_middleware(plan, master, loop, supervisor.session, GUARD)
    transport = middleware.transport
    board = BoardObservations(command_part(plan))
    heartbeat = HeartbeatFile(heartbeat_path(control or control_path(plan.app), master))
    handover = _handover_state(supervisor, heartbeat)
    transport.succeed(handover)
    streams = build_streams(command_part(plan))
    coordinator = Coordinator(transport, streams, board.observations, handover=handover)
    connection = BulkConnection(
        loop, supervisor.bulk_port, supervisor.configuration, board, coordinator
    )
    authority, handler, leases = _create_authority(plan, coordinator, transport, handover, master)
    response = _alarm_response(plan, coordinator, transport, connection)
    RemoteAudit(connection, response, loop)
    topics = len(streams) + len(build_streams(bulk_part(plan)))
    parts: list[Part] = [
        connection,
        GraphPart(coordinator.open_nodes, transport),
        DeliveryEcho(transport),
        OutputWatch(streams, coordinator.alarms, transport, plan.supervision.deliver_within),
        DiagnosticsReports(connection, coordinator, loop, topics),
        NodeReports(connection, middleware, loop, supervisor),
        middleware.create_listener(response),
        AuditWatchdog(connection, coordinator, loop, plan, handover),
        *authority,
    ]
    if link:
        from rtron.guard.lanes.command.service_reports import service_parts  # noqa: PLC0415 - most have none

        parts += service_parts(plan, leases, coordinator, transport, connection, loop, link)
    if plan.incidents.keep:
        parts.append(IncidentNotes(connection, coordinator, loop))
    if socket := open_control_socket(loop, plan, control, handler):
        parts.append(socket)
        heartbeat.beat(loop)
    supervisor.attach(loop, coordinator)
    _set_handlers(coordinator, transport, supervisor)
    run_parts(loop, [*parts, Rehearsal(coordinator, loop, transport.create_stage()), supervisor])


def _create_authority(
    plan: Plan,
    coordinator: Coordinator,
    transport: LiveTransport,
    handover: HandoverState,
    master: str,
) -> tuple[list[Part], RequestHandler, LeaseController]:
    """Return what listens to commanders and stop buttons, with the files of what they stop.

    And what persons may ask for.
    """
    stops, file = LatchedStops(coordinator, transport, plan), stop_file(plan, master)
    stops.keep(handover, file)
    leases = LeaseController(coordinator, transport)
    buttons = StopButtons(plan.stop_sources.buttons, stops, transport)
    handler = create_request_handler(coordinator, transport, leases, stops)
    files = [file, *_keep_intrusions(coordinator, plan, master)]
    return [LeaseTopics(leases, transport), buttons, *files], handler, leases


def _keep_intrusions(coordinator: Coordinator, plan: Plan, master: str) -> list[Part]:
    """Let intrusions outlive the supervisor, where they stop anything; return their file."""
    if plan.audit.on_foreign is not OnForeign.STOP:
        return []
    file = intrusion_file(plan, master)
    coordinator.intrusions.keep(file, {each.topic for each in build_streams(plan)})
    return [file]


def _set_handlers(
    coordinator: Coordinator, transport: LiveTransport, supervisor: SupervisorClient
) -> None:
    """Let the transport tell what it cannot read, and know our supervisor."""
    transport.set_unreadable_handler(UnreadableInputAlarms(coordinator.alarms, transport).report)
    transport.set_supervisor(supervisor.supervisor_participant)


def _handover_state(supervisor: SupervisorClient, heartbeat: HeartbeatFile) -> HandoverState:
    """Return the state of the guard before, with the time of its last heartbeat."""
    handover = supervisor.handover_state
    handover.last_seen_at = heartbeat.previous_time
    return handover


def _alarm_response(
    plan: Plan, coordinator: Coordinator, transport: LiveTransport, connection: BulkConnection
) -> AlarmResponse:
    """Return what the audit's alarms do to the streams of both processes."""
    enforced = [each for each in build_streams(bulk_part(plan)) if each.mode is Mode.ENFORCE]
    others = {each.topic: RemoteBrake(each.topic, connection) for each in enforced}
    on_foreign = plan.audit.on_foreign
    return AlarmResponse(coordinator, transport, on_foreign, dry_run=False, others=others)
