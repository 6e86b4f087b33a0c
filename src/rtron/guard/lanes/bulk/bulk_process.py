"""The bulk process: it carries states and sensor data, counts frames, reads events and reports.

The audit of the graph, the diagnostics and the link to the security service are here, too: nothing
of theirs delays a command.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.audit.common.audit_brake import AuditBrake, Brake
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import UnreadableInputAlarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.incidents.recorder_link import RecorderLink
from rtron.guard.lanes.assignment import bulk_part, command_part
from rtron.guard.lanes.bulk.board_writer import BoardWriter
from rtron.guard.lanes.bulk.command_connection import CommandConnection
from rtron.guard.lanes.bulk.command_nodes import CommandNodes
from rtron.guard.lanes.bulk.remote_response import RemoteResponse
from rtron.guard.lanes.bulk.stand_still import StandStillEnd
from rtron.guard.middleware import Middleware, open_middleware
from rtron.guard.runner import GraphPart, Part, run_parts
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.settings.in_force import SettingsInForce
from rtron.guard.system.process_attributes import allow_many_files, lower_priority
from rtron.guard.system.state_folder import INCIDENTS, state_folder
from rtron.vocabulary import BULK_NODE, Mode, OnForeign, Plan, build_streams

if TYPE_CHECKING:
    import socket
    from collections.abc import Mapping

    from rtron.guard.core.observations import Observations
    from rtron.guard.link.options import LinkOptions
    from rtron.guard.link.service_link import ServiceLink
    from rtron.guard.system.sealed_memory import SharedBeat
    from rtron.guard.transport.common.protocol import LiveTransport

_NICE = 5
"""Commands go before what is carried here (nice(2), SCHED_BATCH of sched(7))."""


@dataclass(frozen=True, slots=True)
class BulkPorts:
    """Where command processes come from, and where the recorder is reached."""

    commands: socket.socket
    recorder: socket.socket


def run_bulk_process(
    plan: Plan,
    master: str,
    ports: BulkPorts,
    configuration: bytes,
    beat: SharedBeat,
    link: LinkOptions | None = None,
) -> None:
    """Serve the command process at a ROS 1 master or in a ROS 2 domain, until stopped.

    `configuration` is the digest of the guard's; the supervisor ends one that has no `beat`.
    """
    lower_priority(_NICE)
    allow_many_files()
    loop = EventLoop()
    middleware = open_middleware(plan, master, loop)
    transport = middleware.transport
    observations = _observations(plan)
    streams = build_streams(bulk_part(plan))
    coordinator = Coordinator(transport, streams, observations, node=BULK_NODE)
    writer = BoardWriter(observations, loop, beat)
    connection = CommandConnection(loop, ports.commands, configuration, writer, coordinator.alarms)
    coordinator.on_observed = writer.refresh
    coordinator.other_statuses = connection.statuses
    transport.set_unreadable_handler(UnreadableInputAlarms(coordinator.alarms, transport).report)
    _follow_brakes(coordinator, transport, connection)
    parts: list[Part] = [GraphPart(coordinator.open, transport), writer]
    settings = service_link = None
    if link:
        settings = SettingsInForce(SettingsApplier(plan, coordinator, transport, bulk_part))
        service_link = _link_service(settings, plan, coordinator, connection, loop, link)
        parts.append(service_link)
    if plan.incidents.keep:
        state = link.state if link else state_folder(plan.app)
        port, folder = ports.recorder, state / INCIDENTS
        recorder = RecorderLink(plan, folder, port, coordinator, loop, settings)
        _connect(recorder, coordinator, connection)
        if service_link:
            recorder.on_saved = service_link.report_incident
        parts.append(recorder)
    parts += _audit_parts(plan, middleware, connection, loop)
    parts.append(connection)
    if plan.ros != 1:
        parts.append(StandStillEnd(loop))
    run_parts(loop, parts)


def _link_service(
    settings: SettingsInForce,
    plan: Plan,
    coordinator: Coordinator,
    connection: CommandConnection,
    loop: EventLoop,
    link: LinkOptions,
) -> ServiceLink:
    """Put the service's last settings in force; return the link, which most guards do not load."""
    from rtron.guard.link.service_link import ServiceLink  # noqa: PLC0415
    from rtron.guard.settings.saved_settings import settings_at_start  # noqa: PLC0415

    settings_at_start(settings, link)
    service_link = ServiceLink(plan, coordinator, settings, loop, link, connection)
    service_link.on_lease_command = partial(connection.call, "lease_command")
    connection.on(lease_response=service_link.receive)
    return service_link


def _connect(
    recorder: RecorderLink, coordinator: Coordinator, connection: CommandConnection
) -> None:
    """Let the recorder have what the command process notes, and say how it is."""
    connection.on(note_entries=recorder.receive)
    coordinator.other_statuses = lambda: [*connection.statuses(), *recorder.statuses()]


def _follow_brakes(
    coordinator: Coordinator, transport: LiveTransport, connection: CommandConnection
) -> None:
    """Let the command process brake the streams here."""
    enforced = [each for each in coordinator.streams if each.spec.mode is Mode.ENFORCE]
    brakes = {each.spec.topic: AuditBrake(each, transport) for each in enforced}
    HeldStreams(brakes).follow(connection)


def _audit_parts(
    plan: Plan, middleware: Middleware, connection: CommandConnection, loop: EventLoop
) -> list[Part]:
    """Return the audit, whose alarms the command process responds to."""
    streams = frozenset(each.topic for each in build_streams(command_part(plan)))
    commands = CommandNodes(connection, loop, streams)
    middleware.transport.set_supervisor(lambda: commands.report.supervisor_participant)
    stops_streams = plan.audit.on_foreign is OnForeign.STOP
    response = RemoteResponse(connection, loop, stops_streams=stops_streams)
    participant = middleware.report_nodes().participant
    connection.connect_listeners.append(partial(connection.call, "participant", participant))
    return [middleware.create_auditor(response, commands), response]


def _observations(plan: Plan) -> Observations:
    """Return what the plan observes; the node of the MSRCN is one of the command process."""
    bulk = observations_of(bulk_part(plan))
    topics = observations_of(plan).publisher_topics
    return replace(bulk, node=f"{bulk.node}_events", publisher_topics=topics)


class HeldStreams:
    """The streams here that the command process holds, in response to the audit's alarms."""

    def __init__(self, brakes: Mapping[str, Brake]) -> None:
        """`brakes` are by the streams' public names.

        A guard that connects after another tells what is stopped: what is not, it never held.
        """
        self._brakes = brakes
        self._held: set[str] = set()

    def follow(self, connection: CommandConnection) -> None:
        """Hold and release the streams as the command process says."""
        connection.on(
            hold=self.hold,
            release=self.release,
            stopped_streams=self.release_others,
            repeat_stop=self.repeat_stop,
        )

    def hold(self, topic: str, reason: str) -> None:
        """Let nothing of a stream pass."""
        if topic in self._brakes:
            self._held.add(topic)
            self._brakes[topic].hold(reason)

    def release_others(self, stopped: frozenset[str]) -> None:
        """Release what is held although it is not stopped."""
        for topic in self._held - stopped:
            self.release(topic)

    def repeat_stop(self, topic: str) -> None:
        """Tell the stop of a stream to a node that has just begun to listen."""
        if topic in self._brakes:
            self._brakes[topic].repeat_stop()

    def release(self, topic: str) -> None:
        """Release a stream, also when only the list of those that are stopped lacks it."""
        if topic in self._brakes:
            self._held.discard(topic)
            self._brakes[topic].release()
