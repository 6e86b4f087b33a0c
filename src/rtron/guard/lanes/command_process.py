"""The command process: it carries what can move the robot, and does nothing else."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from rtron.guard.audit.common.alarm_response import AuditBrakes
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import UnreadableInputAlarms
from rtron.guard.core.control_socket import control_path
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState, HeartbeatFile, heartbeat_path
from rtron.guard.lanes.assignment import command_part
from rtron.guard.lanes.board_observations import BoardObservations
from rtron.guard.lanes.bulk_connection import BulkConnection
from rtron.guard.lanes.lane_reports import LaneReports
from rtron.guard.lanes.orders import Orders
from rtron.guard.lanes.service_reports import ServiceReports
from rtron.guard.middleware import open_middleware
from rtron.guard.runner import (
    GraphPart,
    Part,
    open_control_socket,
    raise_file_limit,
    run_parts,
)
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.in_force import SettingsInForce, settings_at_start
from rtron.guard.settings.local_overrides import OverrideCommands
from rtron.vocabulary import Plan, build_streams

if TYPE_CHECKING:
    from pathlib import Path

    from rtron.guard.link.options import LinkOptions
    from rtron.guard.supervision.supervisor_client import SupervisorClient

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
    raise_file_limit()
    loop = EventLoop()
    middleware = open_middleware(plan, master, loop, supervisor.session)
    transport = middleware.transport
    board = BoardObservations(command_part(plan))
    heartbeat = HeartbeatFile(heartbeat_path(control or control_path(plan.app), master))
    handover = _handover_state(supervisor, heartbeat)
    transport.succeed(handover)
    streams = build_streams(command_part(plan))
    coordinator = Coordinator(transport, streams, board.observations, handover=handover)
    connection = BulkConnection(loop, master, board, coordinator)
    topics = len(build_streams(plan))
    reports = LaneReports(connection, coordinator, loop, middleware, supervisor, topics)
    orders = Orders(AuditBrakes(coordinator, transport), middleware.register_node)
    parts: list[Part] = [GraphPart(coordinator.open_nodes, transport), reports]
    if link:
        settings = SettingsInForce(SettingsApplier(plan, coordinator, transport, command_part))
        settings_at_start(settings, link)
        service_reports = ServiceReports(connection, coordinator, loop, settings)
        orders.apply = service_reports.apply
        parts.append(service_reports)
    overrides = OverrideCommands(coordinator, transport)
    if socket := open_control_socket(loop, plan, control, overrides.handle):
        parts.append(socket)
        heartbeat.beat(loop)
    connection.on_order = orders.obey
    middleware.set_other_pids(connection.pids)
    supervisor.attach(loop, coordinator)
    transport.set_unreadable_handler(UnreadableInputAlarms(coordinator.alarms, transport).report)
    run_parts(loop, [connection, *parts, supervisor])


def _handover_state(supervisor: SupervisorClient, heartbeat: HeartbeatFile) -> HandoverState:
    """Return the state of the guard before, with the time of its last heartbeat."""
    handover = supervisor.handover_state
    handover.last_seen_at = heartbeat.previous_time
    return handover
