"""Running the guard until it is ended."""

from __future__ import annotations

import gc
import logging
import resource
import signal
import sys
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import UnreadableInputAlarms
from rtron.guard.core.control_socket import ControlSocket, RequestHandler, control_path
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState, HeartbeatFile, heartbeat_path
from rtron.guard.core.observations import observations_of
from rtron.guard.measurement.run import RunMeasurement, WriteFigures
from rtron.guard.middleware import open_middleware
from rtron.guard.node_shutdown import ShutdownRefusal, ShutdownSequence
from rtron.guard.rehearsal import Rehearsal
from rtron.guard.settings.local_overrides import OverrideCommands
from rtron.vocabulary import Plan, build_streams

if TYPE_CHECKING:
    from pathlib import Path

    from rtron.guard.link.options import LinkOptions
    from rtron.guard.link.service_link import ServiceLink
    from rtron.guard.middleware import Auditor
    from rtron.guard.supervision.supervisor_client import SupervisorClient
    from rtron.guard.transport.common.protocol import LiveTransport

log = logging.getLogger(__name__)

_SWITCH_S = 1e-4


def run_guard(
    plan: Plan,
    master: str,
    *,
    dry_run: bool = False,
    control: Path | None = None,
    figures: WriteFigures | None = None,
    supervisor_client: SupervisorClient | None = None,
    link: LinkOptions | None = None,
) -> int:
    """Guard a plan's streams on the master or in the domain at `master`; return the exit code.

    A dry run forwards everything and reports what it would have decided. `control` is the socket
    for overrides, by default in the user's runtime folder. `figures` writes what is measured.
    `supervisor_client` connects the guard to its supervisor, `link` to the security service, whose
    last settings are put in force first. SourceError if the plan is for ROS 2, which is not
    installed here, or if `control` cannot be used.
    """
    _raise_file_limit()
    loop = EventLoop()
    middleware = open_middleware(plan, master, loop, dry_run=dry_run)
    transport = middleware.transport
    measuring = RunMeasurement(plan, transport) if figures else None
    observations = measuring.observations if measuring else observations_of(plan)
    heartbeat = HeartbeatFile(heartbeat_path(control or control_path(plan.app), master))
    handover = _handover_state(supervisor_client, heartbeat)
    coordinator = Coordinator(
        transport, build_streams(plan), observations, dry_run=dry_run, handover=handover
    )
    service_link = _service_link(plan, coordinator, transport, loop, link) if link else None
    if supervisor_client:
        supervisor_client.open(loop, coordinator)
        transport.set_supervisor(lambda: supervisor_client.supervisor)
    if measuring and figures:
        measuring.measure(coordinator.streams)
        measuring.write_periodically(figures)
    control_socket = _open_control_socket(
        loop, plan, control, OverrideCommands(coordinator, transport).handle
    )
    if control_socket and not dry_run:
        heartbeat.beat(loop)
    transport.set_unreadable_handler(UnreadableInputAlarms(coordinator.alarms, transport).report)
    auditor = middleware.create_auditor(coordinator)
    run_coordinator(coordinator, transport, loop, auditor, supervisor_client, service_link)
    if measuring and figures:
        figures(measuring.figures())
    if control_socket:
        control_socket.close()
    loop.close()
    return 0


def _service_link(
    plan: Plan,
    coordinator: Coordinator,
    transport: LiveTransport,
    loop: EventLoop,
    link: LinkOptions,
) -> ServiceLink:
    from rtron.guard.link.service_link import ServiceLink  # noqa: PLC0415 - most guards have no service

    return ServiceLink(plan, coordinator, transport, loop, link)


def _handover_state(
    supervisor_client: SupervisorClient | None, heartbeat: HeartbeatFile
) -> HandoverState:
    """Return the state of the guard before, with the time of its last heartbeat."""
    handover = supervisor_client.handover_state if supervisor_client else HandoverState()
    handover.last_seen_at = heartbeat.previous_time
    return handover


def _open_control_socket(
    loop: EventLoop, plan: Plan, control: Path | None, handler: RequestHandler
) -> ControlSocket | None:
    """Open the socket for overrides; the guard runs without one, unless `control` names it."""
    try:
        return ControlSocket(loop, control or control_path(plan.app), handler)
    except SourceError as error:
        if control:
            raise
        log.warning("no overrides: %s", error)
        return None


def run_coordinator(
    coordinator: Coordinator,
    transport: LiveTransport,
    loop: EventLoop,
    auditor: Auditor | None = None,
    supervisor_client: SupervisorClient | None = None,
    service_link: ServiceLink | None = None,
) -> None:
    """Guard until SIGINT, SIGTERM or, unless supervised, a shutdown of the guard's own node."""
    shutdown = (
        ShutdownRefusal(loop)
        if supervisor_client
        else ShutdownSequence(coordinator, transport, loop)
    )
    transport.set_shutdown_handler(shutdown.handle)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: loop.post(loop.stop))
    coordinator.open()
    if service_link:
        service_link.open()
    if auditor:
        auditor.start()
    stage = transport.create_stage()
    Rehearsal(coordinator, loop, stage).begin()
    _reduce_latency()
    log.info("guarding %d topics", len(coordinator.streams))
    loop.run()
    if service_link:
        service_link.close()
    if supervisor_client:
        supervisor_client.close()
    if auditor:
        auditor.close()
    stage.close()
    transport.close()


def _reduce_latency() -> None:
    """Keep garbage collection and the threads of the master's calls from delaying messages."""
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(_SWITCH_S)


def _raise_file_limit() -> None:
    _, hard_limit = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard_limit, hard_limit))
