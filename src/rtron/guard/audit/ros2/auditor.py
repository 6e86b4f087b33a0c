"""The guard's continuous audit in ROS 2: who is in its way, told at each change of the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.common.audit_response import EndpointTrust
from rtron.guard.audit.common.debounced_alarms import BrakingAlarms, DebouncedAlarms
from rtron.guard.audit.ros2.endpoint_checks import planned_publishers
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.graph_alarms import (
    NAME_TIMEOUT,
    drift_alarms,
    duplicate_name_alarms,
    foreign_endpoint_alarms,
)
from rtron.guard.audit.ros2.observed_graph import ROSOUT_TOPIC, GraphReader, ObservedGraph
from rtron.guard.transport.ros2.participants import (
    MAX_LEASE,
    ParticipantLiveness,
    ParticipantState,
)
from rtron.vocabulary import GUARD_NODE, SECOND, Plan
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE
from rtron.wire.ros2.service_names import is_service_topic

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtron.guard.audit.common.audit_response import AuditResponse
    from rtron.guard.audit.common.debounced_alarms import BrakingAlarm
    from rtron.guard.audit.ros2.endpoint_checks import Participants
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.lanes.bulk.command_nodes import CommandNodes
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.wire.ros2.endpoints import Ros2Endpoint

_UNKNOWN_NODES = "the command process has not told its nodes"
_NO_GRAPH = "the graph does not answer"
_NEW_IN_DOMAIN = "the audit has just joined the domain"
_DRIFT_DELAY = 3 * SECOND
_SETTLING_TIME = NAME_TIMEOUT + SECOND
"""How long the graph must have been the same, since discovery has no end that one can see (ns).

By then who waits for its name is told, too.
"""
_DISCOVERY_TIME = 4 * SECOND
"""How long it takes to know a domain (ns): Fast DDS repeats its announcements every 3 s."""


class Ros2Auditor:
    """Audits the plan's enforced streams; does nothing for a plan without one.

    The graph calls at each change and twice a second besides, since some things only time tells.
    """

    def __init__(
        self,
        plan: Plan,
        transport: Ros2Transport,
        response: AuditResponse,
        loop: EventLoop,
        commands: CommandNodes,
    ) -> None:
        """`commands` are the guard's nodes in its other process."""
        self._loop = loop
        self._transport = transport
        self._graph = transport.graph
        self._expected = ExpectedGraph(plan)
        self._response = response
        self._other_participants = commands.participants
        self._unknown_streams = commands.unknown_streams
        self._liveness = ParticipantLiveness(self._graph.participant, transport.processes)
        self._supervisor = b""
        self._braking_alarms = BrakingAlarms(self._response)
        self._drift_alarms = DebouncedAlarms(self._response, _DRIFT_DELAY)
        self._dismissed: dict[bytes, int] = {}
        self._trust = EndpointTrust()
        self._response.dismiss = self._dismiss
        self._response.on_return = self._on_return
        self._response.find_missing = self._find_missing
        self._response.find_unseen = self._find_unseen
        self._joined_at = self._looked_at = loop.now()
        self._seen: frozenset[tuple[bytes, str]] = frozenset()
        """The endpoints at the last look, and the names of their nodes."""
        self._changed_at = loop.now()
        self._gap = "it has not begun" if self._expected.topics else ""
        """Why the last look was not enough to know all intruders, "" if it was."""
        self._graph_reader: GraphReader | None = None
        self._listeners: dict[bytes, str] | None = None

    def open(self) -> None:
        """Audit from now on, if anything is enforced."""
        if not self._expected.topics:
            return
        self._graph_reader = GraphReader(self._transport.session.node(GUARD_NODE))
        for topic in (*self._expected.topics, ROSOUT_TOPIC):
            if not is_service_topic(topic):
                self._graph.watch(topic)
        self._graph.listeners.append(self._look)

    def close(self) -> None:
        """Audit no more."""
        if self._look in self._graph.listeners:
            self._graph.listeners.remove(self._look)

    def look_again(self) -> None:
        """Look at the graph as it is known: the participants of the guard have changed."""
        if self._graph_reader:
            self._update()

    def _look(self) -> None:
        """Look at the graph after a refresh; it counts when all was asked for, and judged."""
        now = self._loop.now()
        self._update()
        if self._graph.is_current:
            self._looked_at = now

    def _update(self) -> None:
        now, observed = self._loop.now(), ObservedGraph(self._endpoints())
        present = {endpoint.participant for endpoint in observed.endpoints}
        self._liveness.update(present, now)
        listed = {endpoint.gid for endpoint in observed.endpoints}
        self._dismissed = {k: v for k, v in self._dismissed.items() if k in listed and now < v}
        observed = observed.without(self._dismissed.keys())
        trusted = self._guard_participants()
        expected, liveness = self._expected, self._liveness
        foreign = foreign_endpoint_alarms(expected, observed, trusted, liveness, now)
        self._braking_alarms.update(
            [*self._judged(foreign), *duplicate_name_alarms(expected, observed, liveness, now)],
            now,
            planned_publishers(expected, observed, trusted),
        )
        self._drift_alarms.update(drift_alarms(expected, observed, trusted), now)
        self._repeat_stops(observed)
        self._tell_trust(trusted)
        self._note_change(observed, now)

    def _note_change(self, observed: ObservedGraph, now: int) -> None:
        """Note when the graph has changed last, and whether this look was enough."""
        before = self._seen
        self._seen = frozenset((each.gid, each.node) for each in observed.endpoints)
        if self._seen != before:
            self._changed_at = now
        has_changed = now - self._changed_at <= _SETTLING_TIME
        changed = f"the graph has changed within the last {_SETTLING_TIME // SECOND} s"
        self._gap = _UNKNOWN_NODES if self._unknown_streams() else changed if has_changed else ""

    def _find_missing(self) -> str:
        return _UNKNOWN_NODES if self._unknown_streams() else self._gap

    def _find_unseen(self, since: int) -> dict[str, str]:
        """Return the streams after which nobody has looked since then, and why."""
        gap = _NO_GRAPH if self._looked_at <= since else ""
        if self._loop.now() - self._joined_at < _DISCOVERY_TIME:
            gap = _NEW_IN_DOMAIN
        streams = {each.stream_topic for each in self._expected.topics.values()}
        unknown = dict.fromkeys(self._unknown_streams(), _UNKNOWN_NODES)
        return dict.fromkeys(streams, gap) if gap else unknown

    def _judged(self, foreign: Sequence[BrakingAlarm]) -> list[BrakingAlarm]:
        """Return what counts: on streams whose process has not told its nodes, nothing new."""
        unknown = self._unknown_streams()
        return [
            each
            for each in foreign
            if not unknown
            or (each.streams and unknown.isdisjoint(each.streams))
            or self._braking_alarms.is_active(each)
        ]

    def _tell_trust(self, trusted: Participants) -> None:
        """Let the process of the brakes know whose messages on the outputs need no answer."""
        trust = EndpointTrust(trusted, frozenset(self._dismissed))
        if trust != self._trust:
            self._trust = trust
            self._response.listen(trust)

    def _on_return(self, gid: bytes) -> None:
        """Look at an endpoint again that was dismissed: it has spoken."""
        if self._dismissed.pop(gid, None):
            self._update()

    def _dismiss(self, stream: str, is_audible: bool) -> str:  # noqa: FBT001 - as `AuditResponse`
        """Take the intruders of a stream for gone although the domain still lists them.

        Return why not: the process of one of them runs. What cannot be heard must have ended for
        certain. Who is still there when its lease must have ended is an intruder.
        """
        intruders = self._braking_alarms.intruders(stream)
        for participant in {each[:PARTICIPANT_SIZE] for each in intruders}:
            state = self._liveness.state(participant)
            if state is ParticipantState.RUNNING or (
                not is_audible and state is not ParticipantState.ENDED
            ):
                return f"the intruder may still speak: {self._label(participant)}"
        self._dismissed |= dict.fromkeys(intruders, self._loop.now() + MAX_LEASE)
        self._update()
        return ""

    def _label(self, participant: bytes) -> str:
        process = self._liveness.process(participant)
        where = f", process {process[0]}" if process else ""
        return f"the participant {participant.hex()}{where}"

    def _endpoints(self) -> Iterator[Ros2Endpoint]:
        """Yield everybody's endpoints, and our own where we have to be heard."""
        for topic in (*self._expected.topics, ROSOUT_TOPIC):
            if not is_service_topic(topic):
                endpoints = self._graph.endpoints(topic)
                yield from endpoints.publishers
                yield from endpoints.subscribers
        if self._graph_reader:
            service_topics = (topic for topic in self._expected.topics if is_service_topic(topic))
            yield from (
                endpoint
                for endpoint in self._graph_reader.endpoints(service_topics)
                if endpoint.participant not in self._graph.ended
            )
            outputs = [
                each for each in self._expected.outputs.values() if not is_service_topic(each)
            ]
            output_endpoints = self._graph_reader.endpoints(outputs)
            yield from (
                endpoint for endpoint in output_endpoints if self._graph.is_own(endpoint.gid)
            )

    def _guard_participants(self) -> Participants:
        """Return those of the guard's processes, as these tell: a name, or an id, is a claim.

        The supervisor stays when the command process that has told it is gone.
        """
        self._supervisor = self._transport.supervisor_participant() or self._supervisor
        own = {self._graph.participant, self._supervisor, *self._other_participants()}
        return frozenset(own - {b""})

    def _repeat_stops(self, observed: ObservedGraph) -> None:
        """Tell a stop that has just been said to who begins to listen after it."""
        listeners = {
            endpoint.gid: self._expected.topics[private].stream_topic
            for private in self._expected.outputs.values()
            for endpoint in observed.subscribers(private)
            if self._expected.topics[private].may_subscribe(endpoint.node)
        }
        before, self._listeners = self._listeners, listeners
        for gid in listeners.keys() - (listeners if before is None else before).keys():
            self._response.on_new_listener(listeners[gid])
