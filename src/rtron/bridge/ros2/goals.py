"""The goals that one client sends to one action of ROS 2 (design.ros2.org: actions).

The parts of an action's messages lie behind the goal's id, 16 bytes, which shifts no alignment.
"""

from __future__ import annotations

import uuid
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import RTronError, SourceError
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.messages.ros2.actions import ID_SIZE, feedback_id
from rtron.vocabulary import SECOND, Ros2ActionEntity, ros2_entity_name

if TYPE_CHECKING:
    from rtron.bridge.common.client_node import NodeListener
    from rtron.bridge.protocol.effects import SendGoal
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.guard.transport.ros2.service_endpoints import CalledService

_RETRY = SECOND // 20
_LOOK = SECOND
"""How often it is looked whether the server of goals that are not done is still there, ns."""
_NO_STAMP = bytes(8)
_UNKNOWN_GOAL = 2
"""What action_msgs/CancelGoal answers for a goal that the server has not accepted (yet)."""
_SERVICES = {
    Ros2ActionEntity.SEND_GOAL: "SendGoalService",
    Ros2ActionEntity.GET_RESULT: "GetResultService",
    Ros2ActionEntity.CANCEL_GOAL: "CancelGoalService",
}


class ClientGoals:
    """Sends goals to an action as a node, and tells the listener what becomes of them."""

    def __init__(
        self,
        loop: EventLoop,
        transport: Ros2Transport,
        node: str,
        request: SendGoal,
        listener: NodeListener,
    ) -> None:
        self._loop = loop
        self._transport = transport
        self._listener = listener
        self._waiting: set[int] = set()
        self._ids: dict[int, bytes] = {}
        self._cancelled: set[int] = set()
        self._sent: dict[tuple[Ros2ActionEntity, int], int] = {}
        self._is_leaving = False
        package, _, name = request.type.replace("/action/", "/").partition("/")
        action, type = request.action, f"{package}/action/{name}"
        self._services: dict[Ros2ActionEntity, CalledService] = {
            entity: transport.create_client(
                node,
                ros2_entity_name(action, entity),
                type,
                partial(self._on_response, entity),
                part,
            )
            for entity, part in _SERVICES.items()
        }
        self._feedback = transport.create_feedback_reader(node, action, type, self._on_feedback)

    def send(self, request: SendGoal, deadline: int) -> None:
        """Send a goal, as soon as the action has a server, until `deadline` (ns)."""
        self._waiting.add(request.number)
        self._try_to_send(request, deadline)

    def cancel(self, number: int) -> None:
        """Ask for the cancel of a goal, and never send one that waits; nothing if it is done."""
        if number in self._waiting:
            self._end(number, SourceError("the goal was cancelled before it was served"))
        elif number in self._ids:
            self._cancelled.add(number)
            self._ask_for_cancel(number)

    def leave(self) -> None:
        """Ask for the cancel of all goals that are not done; nobody hears of them any more."""
        self._is_leaving = True
        self._waiting.clear()
        for number in list(self._ids):
            self.cancel(number)

    @property
    def are_done(self) -> bool:
        """Whether the server has heard what was asked of it: no goal is left behind."""
        return not self._ids

    def close(self) -> None:
        """Leave the graph."""
        self._ids.clear()
        self._transport.remove_client(self._feedback)
        for service in self._services.values():
            self._transport.remove_client(service)

    def _try_to_send(self, request: SendGoal, deadline: int) -> None:
        now = self._loop.now()
        if request.number not in self._waiting:
            return
        if self._is_served:
            self._send_now(request, now)
        elif now > deadline:
            self._end(request.number, SourceError(f"nobody serves {request.action}"))
        else:
            self._loop.call_at(now + _RETRY, partial(self._try_to_send, request, deadline))

    def _send_now(self, request: SendGoal, now: int) -> None:
        self._waiting.discard(request.number)
        id = self._ids[request.number] = uuid.uuid4().bytes
        message = _message(id + request.goal[PREFIX:])
        self._call(Ros2ActionEntity.SEND_GOAL, request.number, message)
        if len(self._ids) == 1:
            self._loop.call_at(now + _LOOK, self._look_for_server)

    def _ask_for_cancel(self, number: int) -> None:
        message = _message(self._ids[number] + _NO_STAMP)
        self._call(Ros2ActionEntity.CANCEL_GOAL, number, message)

    @property
    def _is_served(self) -> bool:
        return all(service.is_available for service in self._services.values())

    def _call(self, entity: Ros2ActionEntity, number: int, message: bytes) -> None:
        try:
            self._sent[entity, self._services[entity].call(message)] = number
        except RTronError as error:
            self._end(number, error)

    def _on_response(self, entity: Ros2ActionEntity, sent: int, response: bytes) -> None:
        number = self._sent.pop((entity, sent), 0)
        if number not in self._ids:
            return
        if entity is Ros2ActionEntity.GET_RESULT:
            self._end(number, response)
        elif entity is Ros2ActionEntity.SEND_GOAL:
            self._on_answer(number, is_accepted=response[PREFIX : PREFIX + 1] == b"\1")
        elif self._is_leaving and response[PREFIX] != _UNKNOWN_GOAL:
            del self._ids[number]

    def _on_answer(self, number: int, *, is_accepted: bool) -> None:
        """Ask for the result of a goal that is accepted, and for its cancel if that came first."""
        if not is_accepted:
            self._end(number, SourceError("the goal was rejected"))
            return
        self._call(Ros2ActionEntity.GET_RESULT, number, _message(self._ids[number]))
        if number in self._cancelled:
            self._ask_for_cancel(number)

    def _on_feedback(self, message: bytes) -> None:
        id = feedback_id(message)
        for number, own in self._ids.items():
            if own == id:
                feedback = message[:PREFIX] + message[PREFIX + ID_SIZE :]
                self._listener.on_feedback(number, feedback)
                return

    def _look_for_server(self) -> None:
        """End the goals of a server that is gone, from which no result comes."""
        if not self._ids:
            return
        if self._is_served:
            self._loop.call_at(self._loop.now() + _LOOK, self._look_for_server)
            return
        for number in list(self._ids):
            self._end(number, SourceError("the server of the goal is gone"))

    def _end(self, number: int, result: bytes | RTronError) -> None:
        self._waiting.discard(number)
        self._cancelled.discard(number)
        self._ids.pop(number, None)
        if not self._is_leaving:
            self._listener.on_result(number, result)


def _message(body: bytes) -> bytes:
    return Encoding.CDR.prefix(len(body)) + body
