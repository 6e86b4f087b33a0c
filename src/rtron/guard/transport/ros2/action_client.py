"""An action of ROS 2 as its server sees it: the guard is the one client under the private name."""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.serialization import deserialize_message

from rtron.errors import WireError
from rtron.guard.action.ros2.endpoints import CancelResponse
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.transport.ros2.action_server import (
    QUEUE_DEPTH,
    ActionContext,
    goal_info,
    services_qos,
)
from rtron.guard.transport.ros2.participants import ParticipantState
from rtron.guard.transport.ros2.rcl import EventFd
from rtron.guard.transport.ros2.service_calls import ServiceCalls
from rtron.vocabulary import (
    ROS2_ACTION_SERVICES,
    ROS2_ACTION_TOPICS,
    SECOND,
    Ros2ActionEntity,
    matches_node,
    ros2_entity_name,
)
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE
from rtron.wire.ros2.service_names import reply_topic

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.action.ros2.endpoints import CancelReply, GoalReply
    from rtron.guard.transport.ros2.action_relay import ActionRelay
    from rtron.guard.transport.ros2.sender_ids import SenderIds
    from rtron.messages.ros2.actions import GoalMessage
    from rtron.wire.ros2.endpoints import Ros2Endpoint


log = logging.getLogger(__name__)

_TOPIC_QOS = {
    Ros2ActionEntity.FEEDBACK: QoSProfile(depth=QUEUE_DEPTH),
    Ros2ActionEntity.STATUS: qos_profile_action_status_default,
}


class ActionClient:
    """Asks the server, and tells `listener` what it says and whether it is there.

    It comes when all of its services answer and one planned node, whose name is its own, tells the
    status; it stays for as long as that one's endpoint is there, whoever comes beside it. Who
    answers a request, ROS 2 does not say: while others offer to serve, or to answer, the server is
    in doubt. DDS makes known who can answer before the answer can come.
    """

    def __init__(
        self,
        action: str,
        servers: tuple[str, ...],
        listener: ActionRelay,
        context: ActionContext,
    ) -> None:
        self._action = action
        self._servers = servers
        self._listener = listener
        self._context = context
        self._clients: dict[Ros2ActionEntity, Any] = {}
        self._event_fds: list[EventFd] = []
        self._subscriptions: list[Any] = []
        self._pending_requests: dict[tuple[Ros2ActionEntity, int], Callable[[Any], None]] = {}
        self._server: Ros2Endpoint | None = None
        self._doubt_reason = self._last_logged = ""
        self._early_status: tuple[bytes, bytes] = (b"", b"")
        self._log_throttle = LogThrottle()

    def open(self) -> None:
        """Join the graph."""
        context = self._context
        for end in ROS2_ACTION_SERVICES:
            client = context.node.create_client(
                context.service_class(end),
                ros2_entity_name(self._action, end),
                qos_profile=services_qos(),
            )
            self._clients[end] = client
            self._notify("client", client.handle, partial(self._on_responses, end))
        for end in ROS2_ACTION_TOPICS:
            self._subscribe(end)
        for topic in (
            ros2_entity_name(self._action, Ros2ActionEntity.STATUS),
            *map(self._reply_topic, ROS2_ACTION_SERVICES),
        ):
            context.shared.graph.watch(topic)
        context.shared.graph.listeners.append(self._update_server)

    def close(self) -> None:
        """Leave the graph."""
        self._context.shared.graph.listeners.remove(self._update_server)
        for client in self._clients.values():
            self._context.node.destroy_client(client)
        for subscription in self._subscriptions:
            self._context.node.destroy_subscription(subscription)
        for event_fd in self._event_fds:
            event_fd.stop()
        self._clients.clear()

    def send_goal(self, goal: GoalMessage, on_reply: GoalReply) -> None:
        """Send a goal."""
        request = self._context.service_class(Ros2ActionEntity.SEND_GOAL).Request()
        request.goal_id.uuid = list(goal.id)
        request.goal = deserialize_message(bytes(goal), self._context.action_class.Goal)

        def on_response(response: Any) -> None:  # noqa: ANN401 - a generated class
            on_reply(_nanoseconds(response.stamp) if response.accepted else None)

        if not self._send_request(Ros2ActionEntity.SEND_GOAL, request, on_response):
            self._context.shared.loop.call_at(
                self._context.shared.loop.now(), partial(on_reply, None)
            )

    def cancel(self, id: bytes, stamp: int, on_reply: CancelReply) -> None:
        """Send a cancel."""
        request = self._context.service_class(Ros2ActionEntity.CANCEL_GOAL).Request()
        request.goal_info = goal_info(id, stamp)

        def on_response(response: Any) -> None:  # noqa: ANN401 - a generated class
            goals = [
                (bytes(g.goal_id.uuid), _nanoseconds(g.stamp)) for g in response.goals_canceling
            ]
            on_reply(CancelResponse(response.return_code, goals))

        self._send_request(Ros2ActionEntity.CANCEL_GOAL, request, on_response)

    def get_result(self, id: bytes, on_reply: Callable[[int, object], None]) -> None:
        """Ask for a result."""
        request = self._context.service_class(Ros2ActionEntity.GET_RESULT).Request()
        request.goal_id.uuid = list(id)
        self._send_request(
            Ros2ActionEntity.GET_RESULT, request, lambda r: on_reply(r.status, r.result)
        )

    def _send_request(
        self, end: Ros2ActionEntity, request: object, on_response: Callable[[Any], None]
    ) -> bool:
        try:
            number = self._context.requests.send_request(self._clients[end].handle, request)
        except WireError as error:
            self._log_problem(str(error))
            return False
        self._pending_requests[end, number] = on_response
        return True

    def _on_responses(self, end: Ros2ActionEntity, count: int) -> None:
        cls = self._context.service_class(end).Response
        for _ in range(count):
            try:
                response_and_number = self._context.requests.take_response(
                    self._clients[end].handle, cls
                )
            except WireError as error:
                self._log_problem(f"an answer is dropped: {error}")
                continue
            if response_and_number is None:
                return
            number, response = response_and_number
            on_response = self._pending_requests.pop((end, number), None)
            if on_response and self._server:
                self._context.shared.graph.query(self._reply_topic(end))
                self._report_doubt(self._offering_endpoints())
                on_response(response)

    def _subscribe(self, end: Ros2ActionEntity) -> None:
        feedback = self._context.action_class.Impl.FeedbackMessage
        subscription = self._context.node.create_subscription(
            feedback if end is Ros2ActionEntity.FEEDBACK else GoalStatusArray,
            ros2_entity_name(self._action, end),
            lambda _message: None,
            _TOPIC_QOS[end],
            raw=True,
        )
        self._subscriptions.append(subscription)
        take = partial(self._on_messages, end, subscription.handle.pointer)
        self._notify("subscription", subscription.handle, take)

    def _on_messages(self, end: Ros2ActionEntity, pointer: int, count: int) -> None:
        for _ in range(count):
            message_and_gid = self._context.shared.rcl.take(pointer)
            if message_and_gid is None:
                return
            message, gid = message_and_gid
            if self._server and gid[:PARTICIPANT_SIZE] == self._server.participant:
                self._listener.on_server_message(end, message)
            elif end is Ros2ActionEntity.STATUS:
                self._early_status = (gid[:PARTICIPANT_SIZE], message)

    def _update_server(self) -> None:
        """Look who serves the action now; a doubt is told before goals can go to who comes."""
        servers = self._offering_endpoints()
        server = self._select_server(servers)
        if self._server and (server is None or server.gid != self._server.gid):
            self._server = None
            self._pending_requests.clear()
            self._listener.on_server_lost()
        self._report_doubt(servers)
        if server and self._server is None:
            self._set_server(server)

    def _report_doubt(self, servers: list[Ros2Endpoint]) -> None:
        doubt = self._doubt_about(servers)
        self._log_once(doubt)
        if doubt != self._doubt_reason:
            self._doubt_reason = doubt
            self._listener.on_server_doubt(doubt)

    def _set_server(self, server: Ros2Endpoint) -> None:
        """Follow a server from now on."""
        self._server = server
        self._pending_requests.clear()
        self._listener.on_server_available(server.node, server.gid)
        participant, message = self._early_status
        if participant == server.participant:
            self._listener.on_server_message(Ros2ActionEntity.STATUS, message)

    def _offering_endpoints(self) -> list[Ros2Endpoint]:
        """Return everybody who lives and offers to serve."""
        return self._live_publishers(ros2_entity_name(self._action, Ros2ActionEntity.STATUS))

    def _live_publishers(self, topic: str) -> list[Ros2Endpoint]:
        shared = self._context.shared
        publishers = shared.graph.endpoints(topic).publishers
        return [
            each
            for each in publishers
            if shared.liveness.state(each.participant) is not ParticipantState.ENDED
        ]

    def _reply_topic(self, end: Ros2ActionEntity) -> str:
        return reply_topic(ros2_entity_name(self._action, end))

    def _select_server(self, servers: list[Ros2Endpoint]) -> Ros2Endpoint | None:
        """Return the server in force while it is there, else the one that is in the right."""
        if not all(client.service_is_ready() for client in self._clients.values()):
            return None
        if self._server:
            current = next((each for each in servers if each.gid == self._server.gid), None)
            if current:
                return current
        candidates = [each for each in servers if self._is_planned_server(each)]
        return candidates[0] if len(candidates) == 1 else None

    def _is_planned_server(self, endpoint: Ros2Endpoint) -> bool:
        """Tell whether the plan means this one, and its name is its own."""
        planned = any(matches_node(name, endpoint.node) for name in self._servers)
        return planned and self._context.shared.owners.is_owner(endpoint.node, endpoint.participant)

    def _doubt_about(self, servers: list[Ros2Endpoint]) -> str:
        """Return why somebody else than the server may answer, "" if nobody may."""
        if len(servers) > 1:
            return f"{len(servers)} nodes serve it: none is sent a goal"
        unplanned = next(
            (each for each in servers if each.node and not self._is_planned_server(each)), None
        )
        if unplanned:
            return f"{printable(unplanned.node)} is not the planned server"
        participants = {each.participant for each in servers}
        replying = (
            each
            for end in ROS2_ACTION_SERVICES
            for each in self._live_publishers(self._reply_topic(end))
        )
        other = next(
            (each for each in replying if participants and each.participant not in participants),
            None,
        )
        return f"{printable(other.node) or 'a node'} answers in its place" if other else ""

    def _notify(self, kind: str, handle: Any, on_count: Callable[[int], None]) -> None:  # noqa: ANN401
        event_fd = EventFd(self._context.shared.loop, on_count)
        self._event_fds.append(event_fd)
        self._context.shared.rcl.notify(kind, handle, event_fd.fd)

    def _log_once(self, why: str) -> None:
        """Say what is wrong with who serves when that changes, and not too often."""
        if why != self._last_logged and self._log_throttle.allows(
            "server", self._context.shared.loop.now()
        ):
            self._last_logged = why
            log.warning("%s: %s", self._action, why or "no other node serves it any more")

    def _log_problem(self, why: str) -> None:
        if self._log_throttle.allows("complaint", self._context.shared.loop.now()):
            log.warning("%s: %s", self._action, why)


def _nanoseconds(time: Any) -> int:  # noqa: ANN401 - builtin_interfaces/Time
    return int(time.sec) * SECOND + int(time.nanosec)


class GoalCanceller:
    """A client of an action's cancels under its public name; answers are not waited for."""

    def __init__(self, node: Node, action: str, sender_ids: SenderIds) -> None:
        self._action = action
        self._requests = ServiceCalls(sender_ids)
        name = ros2_entity_name(action, Ros2ActionEntity.CANCEL_GOAL)
        self._client = node.create_client(
            CancelGoal, name, qos_profile=qos_profile_services_default
        )

    def __call__(self, id: bytes) -> None:
        """Ask for the cancel of the goal with this id."""
        try:
            request = CancelGoal.Request(goal_info=goal_info(id, 0))
            self._requests.send_request(self._client.handle, request)
        except WireError as error:
            log.warning("%s: %s", self._action, error)
