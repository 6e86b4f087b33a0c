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
from rtron.guard.action.ros2.endpoints import GoalMessage
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.transport.ros2.client_resolver import Callers
from rtron.guard.transport.ros2.event_fd import Bell
from rtron.guard.transport.ros2.pace import Pace
from rtron.guard.transport.ros2.service_calls import PLACE_SIZE
from rtron.vocabulary import REQUESTED, SECOND, ActionEnd, end_name
from rtron.wire.ros2.endpoints import GID_SIZE, PARTICIPANT

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.action.ros2.endpoints import Cancelled, Hears
    from rtron.guard.transport.common.protocol import Peer, TypeInfo
    from rtron.guard.transport.ros2.context import Surroundings
    from rtron.guard.transport.ros2.service_calls import Letter, Requests

log = logging.getLogger(__name__)

READ_AHEAD = 1000
"""So many requests, or answers, wait to be taken."""
_FEEDBACK = QoSProfile(depth=10)
_MEETING = 2 * SECOND
"""So long a client takes to find a service that answers in the place of another."""


@dataclass(frozen=True, slots=True)
class Around:
    """What all ends of an action share; `cls` is rclpy's class of the action."""

    node: Node
    cls: Any
    info: TypeInfo
    shared: Surroundings
    requests: Requests

    def service(self, end: ActionEnd) -> Any:  # noqa: ANN401 - a generated class
        """Return the class of one of the action's services."""
        impl = self.cls.Impl
        return {
            ActionEnd.SEND_GOAL: impl.SendGoalService,
            ActionEnd.CANCEL_GOAL: impl.CancelGoalService,
            ActionEnd.GET_RESULT: impl.GetResultService,
        }[end]


def services_qos() -> QoSProfile:
    """Return the QoS of services, with room for many at once."""
    return QoSProfile(depth=READ_AHEAD)


class Front:
    """Hands what clients ask to `hears`, named by their flow; offered only while it is open."""

    def __init__(
        self, action: str, flow: str, publisher: str, hears: Hears, around: Around
    ) -> None:
        self.flow = flow
        self._action = action
        self._hears = hears
        self._around = around
        self._callers = Callers(action, publisher, around.info, around.shared)
        self._services: dict[ActionEnd, Any] = {}
        self._bells: list[Bell] = []
        self._publishers: dict[ActionEnd, Any] = {}
        self._opened = 0
        self._unmet: list[Callable[[], None]] = []
        self._pace = Pace(around.shared.loop)
        self._seldom = Seldom()

    def open(self) -> None:
        """Be there for clients."""
        if self._services:
            return
        self._opened = self._around.shared.loop.now()
        around, node = self._around, self._around.node
        for end, cls, qos in (
            (ActionEnd.FEEDBACK, around.cls.Impl.FeedbackMessage, _FEEDBACK),
            (ActionEnd.STATUS, GoalStatusArray, qos_profile_action_status_default),
        ):
            name = end_name(self._action, end)
            self._publishers[end] = node.create_publisher(cls, name, qos)
        for end in REQUESTED:
            self._open_service(end)
        unmet, self._unmet = self._unmet, []
        for again in unmet:
            again()

    def close(self) -> None:
        """Be there no more."""
        for service in self._services.values():
            self._around.node.destroy_service(service)
        for bell in self._bells:
            bell.silence()
        for publisher in self._publishers.values():
            self._around.node.destroy_publisher(publisher)
        self._bells.clear()
        self._services.clear()
        self._publishers.clear()

    def leave(self) -> None:
        """Close for good."""
        self.close()
        self._callers.close()

    def tell(self, end: ActionEnd, message: bytes) -> None:
        """Publish a feedback message or a status array."""
        publisher = self._publishers.get(end)
        if publisher:
            self._around.shared.rcl.publish(publisher.handle.pointer, message)

    def place(self, token: str) -> ResultPlace | None:
        """Return where a request of a former life of this service is answered."""
        try:
            place = bytes.fromhex(token)
        except ValueError:
            return None
        return ResultPlace(self, place, former=True) if len(place) == PLACE_SIZE else None

    def give_result(
        self, place: bytes, status: int, result: object | None, *, former: bool = False
    ) -> None:
        """Answer a request for a result, maybe one that a former guard has taken."""
        if former and not self._may_meet(partial(self.give_result, place, status, result)):
            return
        if former:
            place = self._of_writer(ActionEnd.GET_RESULT, place)
        cls = self._around.service(ActionEnd.GET_RESULT).Response
        given = self._around.cls.Result() if result is None else result
        self._respond(ActionEnd.GET_RESULT, place, cls(status=status, result=given))

    def _may_meet(self, again: Callable[..., None]) -> bool:
        """Tell whether clients of a former guard have found this one; call again when they have."""
        again = partial(again, former=True)
        if not self._services:
            self._unmet.append(again)
            return False
        early = self._opened + _MEETING - self._around.shared.loop.now()
        if early > 0:
            self._around.shared.loop.call_later(early / SECOND, again)
        return early <= 0

    def _of_writer(self, end: ActionEnd, place: bytes) -> bytes:
        """Return the place of a request by its writer's GUID, where Fast DDS gave its reader's.

        Fast DDS answers at a reader only if the same service has taken a request from it; clients
        take what is answered at either.
        """
        node, name = self._around.node, f"rq{end_name(self._action, end)}Request"
        infos = node.get_publishers_info_by_topic(name, no_mangle=True)
        gids = [bytes(info.endpoint_gid)[:GID_SIZE] for info in infos]
        own = [gid for gid in gids if gid[:PARTICIPANT] == place[:PARTICIPANT]]
        return own[0] + place[GID_SIZE:] if len(own) == 1 else place

    def _open_service(self, end: ActionEnd) -> None:
        around = self._around
        service = around.node.create_service(
            around.service(end),
            end_name(self._action, end),
            lambda _request, response: response,
            qos_profile=services_qos(),
        )
        self._services[end] = service
        bell = Bell(around.shared.loop, partial(self._take, end))
        self._bells.append(bell)
        around.shared.rcl.notify("service", service.handle, bell.fd)

    def _take(self, end: ActionEnd, count: int) -> None:
        cls = self._around.service(end).Request
        for _ in range(count):
            try:
                taken = self._around.requests.take_request(self._services[end].handle, cls)
            except WireError as error:
                self._complain(f"a request is dropped: {error}")
                continue
            if taken is None:
                return
            place, letter = taken
            self._callers.name(place, partial(self._open_letter, end, place, letter))

    def _open_letter(self, end: ActionEnd, place: bytes, letter: Letter, peer: Peer) -> None:
        """Hand on a request whose sender is known."""
        asked = {
            ActionEnd.SEND_GOAL: self._goal,
            ActionEnd.CANCEL_GOAL: self._cancel,
            ActionEnd.GET_RESULT: self._result,
        }[end]
        try:
            asked(place, letter, peer)
        except WireError as error:
            self._complain(f"a request of {peer.node} is dropped: {error}")

    def _goal(self, place: bytes, letter: Letter, peer: Peer) -> None:
        answer = partial(self._admit, place)
        self._hears.goal_asked(self.flow, peer, partial(_goal_in, letter), answer)

    def _admit(self, place: bytes, stamp: int | None) -> None:
        response = self._around.service(ActionEnd.SEND_GOAL).Response()
        response.accepted = stamp is not None
        response.stamp.sec, response.stamp.nanosec = divmod(stamp or 0, SECOND)
        self._respond(ActionEnd.SEND_GOAL, place, response)

    def _result(self, place: bytes, letter: Letter, peer: Peer) -> None:
        answer = ResultPlace(self, place)
        self._hears.result_asked(self.flow, peer, _id(letter.read().goal_id), answer)

    def _cancel(self, place: bytes, letter: Letter, peer: Peer) -> None:
        info = letter.read().goal_info
        stamp = info.stamp.sec * SECOND + info.stamp.nanosec
        answer = partial(self._cancelled, place)
        self._hears.cancel_asked(self.flow, peer, _id(info.goal_id), stamp, answer)

    def _cancelled(self, place: bytes, cancelled: Cancelled) -> None:
        response = self._around.service(ActionEnd.CANCEL_GOAL).Response()
        response.return_code = cancelled.code
        response.goals_canceling = [goal_info(id, stamp) for id, stamp in cancelled.goals]
        self._respond(ActionEnd.CANCEL_GOAL, place, response)

    def _respond(self, end: ActionEnd, place: bytes, response: object) -> None:
        self._pace.send(partial(self._send, end, place, response))

    def _send(self, end: ActionEnd, place: bytes, response: object) -> None:
        service = self._services.get(end)
        if service is None:
            self._complain("an answer is lost: the action is not offered any more")
            return
        try:
            self._around.requests.respond(service.handle, place, response)
        except WireError as error:
            self._complain(f"an answer is lost: {error}")

    def _complain(self, why: str) -> None:
        if self._seldom.may_say("complaint", self._around.shared.loop.now()):
            log.warning("%s: %s", self._action, why)


class ResultPlace:
    """Where one request for a result is answered, now or by a later guard."""

    def __init__(self, front: Front, place: bytes, *, former: bool = False) -> None:
        self._front = front
        self._place = place
        self._former = former
        self.token = f"{front.flow} {place.hex()}"

    def __call__(self, status: int, result: object | None) -> None:
        """Answer."""
        self._front.give_result(self._place, status, result, former=self._former)


def goal_info(id: bytes, stamp: int) -> GoalInfo:
    """Return what names a goal in a cancel."""
    info = GoalInfo()
    info.goal_id.uuid = list(id)
    info.stamp.sec, info.stamp.nanosec = divmod(stamp, SECOND)
    return info


def _goal_in(letter: Letter) -> GoalMessage:
    request = letter.read()
    return GoalMessage.of(_id(request.goal_id), serialize_message(request.goal))


def _id(goal_id: Any) -> bytes:  # noqa: ANN401 - unique_identifier_msgs/UUID
    return bytes(goal_id.uuid)
