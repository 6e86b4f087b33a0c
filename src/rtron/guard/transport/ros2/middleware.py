"""The guard's transport for ROS 2: many nodes in one participant, raw messages, no executor."""

from __future__ import annotations

import logging
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.memory import Stage
from rtron.guard.transport.common.protocol import (
    DEFAULT_OUTPUT,
    ConnectHandler,
    InputOptions,
    Output,
    OutputOptions,
    SubscriberProgress,
)
from rtron.guard.transport.ros2.action_client import GoalCanceller
from rtron.guard.transport.ros2.action_relay import ActionRelay
from rtron.guard.transport.ros2.context import TransportContext
from rtron.guard.transport.ros2.data_reader import DataListener, DataReader, FeedbackReader
from rtron.guard.transport.ros2.graph import RosGraph
from rtron.guard.transport.ros2.participants import MAX_LEASE, NameOwners, ParticipantLiveness
from rtron.guard.transport.ros2.process_table import ProcessTable
from rtron.guard.transport.ros2.publication import Publication
from rtron.guard.transport.ros2.qos import profile
from rtron.guard.transport.ros2.rcl import Rcl
from rtron.guard.transport.ros2.sender_ids import find_sender_ids
from rtron.guard.transport.ros2.service_endpoints import CalledService, OfferedService
from rtron.guard.transport.ros2.subscription import Subscription
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import GUARD_NODE, SECOND, QoS, Reliability
from rtron.wire.ros2.discovery_tuning import publishes_without_waiting
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import rmw_identifier

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtron.guard.action.ros2.stream import Ros2ActionStream
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.process_table import Process
    from rtron.vocabulary import Stream
    from rtron.wire.ros2.session import Ros2Session

log = logging.getLogger(__name__)

_PARTICIPANTS = "participants"
_PROCESSES = "processes"
_MAX_PARTICIPANTS = 32
"""More guards do not end within a lease."""
_MAX_PROCESSES = 256
"""So many participants' processes are handed over, the last to come."""
_READER_DEPTH = 100
_SETTLING_TIME = 4 * SECOND
"""Fast DDS repeats its announcements every 3 s."""


class Ros2Transport:
    """Nodes, topics and a clock on ROS 2; everything happens in the loop's thread."""

    encoding = Encoding.CDR

    def __init__(self, loop: EventLoop, session: Ros2Session, node: str = GUARD_NODE) -> None:
        self.session = session
        self._sender_ids = find_sender_ids(session.node(node))
        self.rcl = Rcl(self._sender_ids)
        self.graph = RosGraph(loop, session, self.rcl, node)
        self.processes = ProcessTable()
        self.supervisor_participant: Callable[[], bytes] = bytes
        liveness = ParticipantLiveness(self.graph.participant, self.processes)
        self._owners = NameOwners()
        self._handover = HandoverState()
        self._processes_handed_over: dict[bytes, Process] = {}
        self._start_time = loop.now()
        self.now = loop.now
        self.call_at = loop.call_at
        self._context = TransportContext(
            loop,
            self.rcl,
            self._sender_ids,
            self.graph,
            self._owners,
            liveness,
            _log_unreadable,
        )
        self._publications: list[Publication] = []
        self._subscriptions: list[Subscription] = []
        self._actions: list[ActionRelay] = []
        self._services: list[OfferedService | CalledService | FeedbackReader] = []
        self.graph.listeners.append(self._update_names)

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Do nothing: ROS 2 has no such request."""

    def set_unreadable_handler(self, handler: Callable[[str, str, str], None]) -> None:
        """Call `handler` with a topic, a node, and why its message is unreadable; do not log it."""
        self._context.report_unreadable = handler

    def succeed(self, handover: HandoverState) -> None:
        """Know the participants of the guards before, and leave ours to the next one."""
        ended: list[str] = handover.inherited(_PARTICIPANTS) or []
        self.graph.ended = frozenset(map(bytes.fromhex, ended))
        self.call_at(self.now() + MAX_LEASE, self._forget_ended)
        handover.store(_PARTICIPANTS, [*ended, self.graph.participant.hex()][-_MAX_PARTICIPANTS:])
        processes: dict[str, list[int]] = handover.inherited(_PROCESSES) or {}
        self._context.liveness.inherit(
            {bytes.fromhex(each): (pid, start) for each, (pid, start) in processes.items()}
        )
        self._handover = handover

    def _forget_ended(self) -> None:
        """Hide nobody any more: who is still in the graph has another's id."""
        self.graph.ended = frozenset()
        self._context.liveness.inherit({})

    @property
    def participant(self) -> bytes:
        """The first bytes of the GIDs of this process."""
        return self.graph.participant

    def set_supervisor(self, participant: Callable[[], bytes]) -> None:
        """Take what tells the participant that counts as the guard's."""
        self.supervisor_participant = participant

    def subscriber_progress(self, topic: str) -> Sequence[SubscriberProgress]:
        """Return nothing: rcl tells no single reader's acknowledgements; see `LiveTransport`."""
        del topic
        return ()

    def create_stage(self) -> Stage:
        """Return a stage without endpoints, which DDS would show to others; see `LiveTransport`."""
        return Stage(self.encoding, self.now)

    def advertise(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`."""
        keep_all = options.keep_all and publishes_without_waiting(rmw_identifier())
        return self._publication(node, topic, type, replace(options, keep_all=keep_all))

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`."""
        ros_node = self.session.node(node)
        subscription = Subscription(ros_node, topic, type, on_connect, options, self._context)
        self._subscriptions.append(subscription)

    def create_reader(self, topic: str, type: str, listener: DataListener) -> DataReader:
        """Return a reader of all that is sent on a topic from now on, whatever the QoS.

        It reads our own messages, too. SourceError if the type is not installed.
        """
        any_publisher = profile(QoS(reliability=Reliability.BEST_EFFORT), _READER_DEPTH)
        return DataReader(
            self.session.node(GUARD_NODE),
            find_interface(type).cls,
            topic,
            any_publisher,
            self._context,
            listener,
            is_command=False,
        )

    def create_server(
        self, node: str, service: str, type: str, on_request: Callable[[bytes, bytes], None]
    ) -> OfferedService:
        """Return a service that a node of ours can offer; see `OfferedService`."""
        server = OfferedService(self.session.node(node), service, type, self._context, on_request)
        self._services.append(server)
        return server

    def create_client(
        self,
        node: str,
        service: str,
        type: str,
        on_response: Callable[[int, bytes], None],
        part: str = "",
    ) -> CalledService:
        """Return what calls a service as a node of ours; see `CalledService`."""
        client = CalledService(
            self.session.node(node), service, type, self._context, on_response, part
        )
        self._services.append(client)
        return client

    def action_endpoints(
        self, stream: Stream, node: str, listener: Ros2ActionStream
    ) -> ActionRelay:
        """Return the services and topics of an action; see `ActionRelay`."""
        endpoints = ActionRelay(stream, self.session.node(node), listener, self._context)
        self._actions.append(endpoints)
        return endpoints

    def goal_canceller(self, node: str, action: str) -> GoalCanceller:
        """Return a canceller of goals of an unguarded action."""
        return GoalCanceller(self.session.node(node), action, self._sender_ids)

    def remove_publication(self, node: str, topic: str) -> None:
        """Publish a topic as a node no more; nothing if it does not."""
        for each in [each for each in self._publications if each.is_of(node, topic)]:
            self._publications.remove(each)
            each.leave()

    def remove_subscription(self, node: str, topic: str) -> None:
        """Subscribe to a topic as a node no more; nothing if it does not."""
        for each in [each for each in self._subscriptions if each.is_of(node, topic)]:
            self._subscriptions.remove(each)
            each.close()

    def create_feedback_reader(
        self, node: str, action: str, type: str, on_feedback: Callable[[bytes], None]
    ) -> FeedbackReader:
        """Return what reads an action's feedback as a node of ours; see `FeedbackReader`."""
        ros_node = self.session.node(node)
        reader = FeedbackReader(ros_node, action, type, self._context, on_feedback)
        self._services.append(reader)
        return reader

    def remove_client(self, endpoint: CalledService | FeedbackReader) -> None:
        """Call a service, or read feedback, no more."""
        self._services.remove(endpoint)
        endpoint.close()

    def link_nodes(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Show two nodes of ours as connected; see `Transport`."""
        output = self._publication(publisher, topic, type)
        if type:
            output.internal_readers = 1
            node = self.session.node(subscriber)
            node.create_subscription(find_interface(type).cls, topic, lambda _: None, 1, raw=True)
        return output

    def close(self) -> None:
        """Leave the domain."""
        self.graph.close()
        for subscription in self._subscriptions:
            subscription.close()
        for publication in self._publications:
            publication.close()
        for each in (*self._actions, *self._services):
            each.close()
        self._sender_ids.close()
        self.session.close()

    def _publication(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Publication:
        ros_node = self.session.node(node)
        publication = Publication(ros_node, topic, type, self._context, options)
        self._publications.append(publication)
        return publication

    def _update_names(self) -> None:
        """Update the owners of names; ended participants own none."""
        self._sender_ids.update()
        is_settled = self.now() - self._start_time > _SETTLING_TIME
        self._owners.update(self._live_names(), is_settled=is_settled)
        self._hand_over_processes()

    def _hand_over_processes(self) -> None:
        """Let the next guard know whose process ends, even before it looks."""
        processes = self._context.liveness.certain_processes()
        if processes != self._processes_handed_over:
            self._processes_handed_over = processes
            latest = list(processes.items())[-_MAX_PROCESSES:]
            self._handover.store(_PROCESSES, {each.hex(): process for each, process in latest})

    def _live_names(self) -> list[tuple[str, bytes]]:
        """Return each node name with each participant that has it.

        An ended participant keeps a name that no other one has. Clients and servers of actions have
        their names also at their subscriptions.
        """
        liveness, watched = self._context.liveness, self.graph.watched_endpoints()
        endpoints = [
            endpoint for each in watched for endpoint in (*each.publishers, *each.subscribers)
        ]
        liveness.update((endpoint.participant for endpoint in endpoints), self.now())
        participants_of: dict[str, set[bytes]] = defaultdict(set)
        for endpoint in endpoints:
            participants_of[endpoint.node].add(endpoint.participant)
        shared_names = (group for node, group in participants_of.items() if node and len(group) > 1)
        ended = {each for group in shared_names for each in group - liveness.not_ended(group)}
        return [(node, each) for node, group in participants_of.items() for each in group - ended]


def _log_unreadable(topic: str, node: str, why: str) -> None:
    log.error("%s: %s %s", topic, node or "a node without a name", why)
