"""An action of ROS 2 as its clients see it under one name: three services and two topics."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatusArray
from rclpy.qos import QoSProfile, qos_profile_action_status_default
from rclpy.serialization import serialize_message

from rtron.errors import WireError
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.ros2.client_resolver import ClientResolver
from rtron.guard.transport.ros2.rcl import EventFd
from rtron.guard.transport.ros2.responses import ResponsePacer, ResponseRetry
from rtron.messages.ros2.actions import GoalMessage
from rtron.vocabulary import ROS2_ACTION_SERVICES, SECOND, Ros2ActionEntity, ros2_entity_name
from rtron.wire.ros2.c_structures import GID_SIZE
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE
from rtron.wire.ros2.service_names import request_topic

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.action.ros2.endpoints import CancelResponse
    from rtron.guard.action.ros2.stream import Ros2ActionStream
    from rtron.guard.transport.common.protocol import Peer, TypeInfo
    from rtron.guard.transport.ros2.context import TransportContext
    from rtron.guard.transport.ros2.service_calls import ServiceCalls, ServiceMessage

log = logging.getLogger(__name__)

QUEUE_DEPTH = 1000
"""So many requests, or answers, wait to be taken."""
_FEEDBACK = QoSProfile(depth=10)
_DISCOVERY_TIME = 2 * SECOND
"""So long a client takes to find a service that answers in the place of another."""


@dataclass(frozen=True, slots=True)
class ActionContext:
    """What all ends of an action share; `action_class` is rclpy's class of the action."""

    node: Node
    action_class: Any
    type_info: TypeInfo
    shared: TransportContext
    requests: ServiceCalls

    def service_class(self, end: Ros2ActionEntity) -> Any:  # noqa: ANN401 - a generated class
        """Return the class of one of the action's services."""
        impl = self.action_class.Impl
        return {
            Ros2ActionEntity.SEND_GOAL: impl.SendGoalService,
            Ros2ActionEntity.CANCEL_GOAL: impl.CancelGoalService,
            Ros2ActionEntity.GET_RESULT: impl.GetResultService,
        }[end]


def services_qos() -> QoSProfile:
    """Return the QoS of services, with room for many at once."""
    return QoSProfile(depth=QUEUE_DEPTH)


class ActionServer:
    """Hands what clients ask to `listener`, named by their flow; offered only while it is open."""

    def __init__(
        self,
        action: str,
        flow: str,
        publisher: str,
        listener: Ros2ActionStream,
        context: ActionContext,
    ) -> None:
        self.flow = flow
        self._action = action
        self._listener = listener
        self._context = context
        self._clients = ClientResolver(action, publisher, context.type_info, context.shared)
        self._services: dict[Ros2ActionEntity, Any] = {}
        self._event_fds: list[EventFd] = []
        self._publishers: dict[Ros2ActionEntity, Any] = {}
        self._opened_at = 0
        self._deferred_replies: list[Callable[[], None]] = []
        self._response_pacer = ResponsePacer(context.shared.loop)
        self._response_retry = ResponseRetry(context.shared.loop, action)
        self._log_throttle = LogThrottle()

    def open(self) -> None:
        """Be there for clients."""
        if self._services:
            return
        self._opened_at = self._context.shared.loop.now()
        context, node = self._context, self._context.node
        for end, cls, qos in (
            (Ros2ActionEntity.FEEDBACK, context.action_class.Impl.FeedbackMessage, _FEEDBACK),
            (Ros2ActionEntity.STATUS, GoalStatusArray, qos_profile_action_status_default),
        ):
            name = ros2_entity_name(self._action, end)
            self._publishers[end] = node.create_publisher(cls, name, qos)
        for end in ROS2_ACTION_SERVICES:
            self._open_service(end)
        unmet, self._deferred_replies = self._deferred_replies, []
        for again in unmet:
            again()

    def close(self) -> None:
        """Be there no more."""
        for service in self._services.values():
            self._context.node.destroy_service(service)
        for event_fd in self._event_fds:
            event_fd.stop()
        for publisher in self._publishers.values():
            self._context.node.destroy_publisher(publisher)
        self._event_fds.clear()
        self._services.clear()
        self._publishers.clear()

    def destroy(self) -> None:
        """Close for good."""
        self.close()
        self._clients.close()

    def publish(self, end: Ros2ActionEntity, message: bytes) -> None:
        """Publish a feedback message or a status array."""
        publisher = self._publishers.get(end)
        if publisher:
            self._context.shared.rcl.publish(publisher.handle.pointer, message)

    def restore_reply(self, token: str) -> ResultResponder | None:
        """Return where a request of a former life of this service is answered."""
        try:
            request_id = bytes.fromhex(token)
        except ValueError:
            return None
        if len(request_id) != self._context.shared.sender_ids.request_id_size:
            return None
        send = self._send_inherited_result
        return ResultResponder(self.flow, request_id, send, lambda: self._early() <= 0)

    def _send_result(self, request_id: bytes, status: int, result: object | None) -> None:
        """Answer a request for a result."""
        cls = self._context.service_class(Ros2ActionEntity.GET_RESULT).Response
        message = self._context.action_class.Result() if result is None else result
        self._respond(Ros2ActionEntity.GET_RESULT, request_id, cls(status=status, result=message))

    def _send_inherited_result(self, request_id: bytes, status: int, result: object | None) -> None:
        """Answer a request that a former guard has taken, once its clients have found this one."""
        retry = partial(self._send_inherited_result, request_id, status, result)
        if not self._services:
            self._deferred_replies.append(retry)
            return
        if (early := self._early()) > 0:
            self._context.shared.loop.call_later(early / SECOND, retry)
            return
        request_id = self._writer_request_id(Ros2ActionEntity.GET_RESULT, request_id)
        self._send_result(request_id, status, result)

    def _early(self) -> int:
        """Return how long (ns) the clients of a former guard still need to find this one."""
        found_at = self._opened_at + _DISCOVERY_TIME
        return found_at - self._context.shared.loop.now() if self._services else 0

    def _writer_request_id(self, end: Ros2ActionEntity, request_id: bytes) -> bytes:
        """Return the place of a request by its writer's GUID, where Fast DDS gave its reader's.

        Fast DDS answers at a reader only if the same service has taken a request from it; clients
        take what is answered at either.
        """
        node, name = self._context.node, request_topic(ros2_entity_name(self._action, end))
        infos = node.get_publishers_info_by_topic(name, no_mangle=True)
        gids = [bytes(info.endpoint_gid)[:GID_SIZE] for info in infos]
        client_gids = [
            gid for gid in gids if gid[:PARTICIPANT_SIZE] == request_id[:PARTICIPANT_SIZE]
        ]
        return client_gids[0] + request_id[GID_SIZE:] if len(client_gids) == 1 else request_id

    def _open_service(self, end: Ros2ActionEntity) -> None:
        context = self._context
        service = context.node.create_service(
            context.service_class(end),
            ros2_entity_name(self._action, end),
            lambda _request, response: response,
            qos_profile=services_qos(),
        )
        self._services[end] = service
        event_fd = EventFd(context.shared.loop, partial(self._on_requests, end))
        self._event_fds.append(event_fd)
        context.shared.rcl.notify("service", service.handle, event_fd.fd)

    def _on_requests(self, end: Ros2ActionEntity, count: int) -> None:
        cls = self._context.service_class(end).Request
        for _ in range(count):
            try:
                id_and_request = self._context.requests.take_request(
                    self._services[end].handle, cls
                )
            except WireError as error:
                self._log_problem(f"a request is dropped: {error}")
                continue
            if id_and_request is None:
                return
            request_id, request = id_and_request
            self._clients.resolve(request_id, partial(self._on_request, end, request_id, request))

    def _on_request(
        self, end: Ros2ActionEntity, request_id: bytes, request: ServiceMessage, peer: Peer
    ) -> None:
        """Hand on a request whose sender is known."""
        handler = {
            Ros2ActionEntity.SEND_GOAL: self._on_goal,
            Ros2ActionEntity.CANCEL_GOAL: self._on_cancel,
            Ros2ActionEntity.GET_RESULT: self._on_result_request,
        }[end]
        try:
            handler(request_id, request, peer)
        except WireError as error:
            self._log_problem(f"a request of {peer.node} is dropped: {error}")

    def _on_goal(self, request_id: bytes, request: ServiceMessage, peer: Peer) -> None:
        reply = partial(self._reply_to_goal, request_id)
        self._listener.on_goal_request(self.flow, peer, partial(_decode_goal, request), reply)

    def _reply_to_goal(self, request_id: bytes, stamp: int | None) -> None:
        response = self._context.service_class(Ros2ActionEntity.SEND_GOAL).Response()
        response.accepted = stamp is not None
        response.stamp.sec, response.stamp.nanosec = divmod(stamp or 0, SECOND)
        self._respond(Ros2ActionEntity.SEND_GOAL, request_id, response)

    def _on_result_request(self, request_id: bytes, request: ServiceMessage, peer: Peer) -> None:
        reply = ResultResponder(self.flow, request_id, self._send_result)
        self._listener.on_result_request(
            self.flow, peer, _uuid_bytes(request.decode().goal_id), reply
        )

    def _on_cancel(self, request_id: bytes, request: ServiceMessage, peer: Peer) -> None:
        info = request.decode().goal_info
        stamp = info.stamp.sec * SECOND + info.stamp.nanosec
        reply = partial(self._reply_to_cancel, request_id)
        self._listener.on_cancel_request(self.flow, peer, _uuid_bytes(info.goal_id), stamp, reply)

    def _reply_to_cancel(self, request_id: bytes, result: CancelResponse) -> None:
        response = self._context.service_class(Ros2ActionEntity.CANCEL_GOAL).Response()
        response.return_code = result.code
        response.goals_canceling = [goal_info(id, stamp) for id, stamp in result.goals]
        self._respond(Ros2ActionEntity.CANCEL_GOAL, request_id, response)

    def _respond(self, end: Ros2ActionEntity, request_id: bytes, response: object) -> None:
        send = partial(self._send, end, request_id, response)
        client = request_id[:PARTICIPANT_SIZE]
        self._response_pacer.send(partial(self._response_retry.send, client, send))

    def _send(self, end: Ros2ActionEntity, request_id: bytes, response: object) -> bool:
        service = self._services.get(end)
        if service is None:
            raise WireError("the action is not offered any more")
        return self._context.requests.respond(service.handle, request_id, response)

    def _log_problem(self, why: str) -> None:
        if self._log_throttle.allows("complaint", self._context.shared.loop.now()):
            log.warning("%s: %s", self._action, why)


class ResultResponder:
    """Where one request for a result is answered, now or by a later guard."""

    def __init__(
        self,
        flow: str,
        request_id: bytes,
        send: Callable[[bytes, int, object | None], None],
        is_reachable: Callable[[], bool] = lambda: True,
    ) -> None:
        self._request_id = request_id
        self._send = send
        self._is_reachable = is_reachable
        self.token = f"{flow} {request_id.hex()}"

    @property
    def is_reachable(self) -> bool:
        """Whether the client has had the time to find this service."""
        return self._is_reachable()

    def __call__(self, status: int, result: object | None) -> None:
        """Answer."""
        self._send(self._request_id, status, result)


def goal_info(id: bytes, stamp: int) -> GoalInfo:
    """Return what names a goal in a cancel."""
    info = GoalInfo()
    info.goal_id.uuid = list(id)
    info.stamp.sec, info.stamp.nanosec = divmod(stamp, SECOND)
    return info


def _decode_goal(message: ServiceMessage) -> GoalMessage:
    request = message.decode()
    return GoalMessage.of(_uuid_bytes(request.goal_id), serialize_message(request.goal))


def _uuid_bytes(goal_id: Any) -> bytes:  # noqa: ANN401 - unique_identifier_msgs/UUID
    return bytes(goal_id.uuid)
