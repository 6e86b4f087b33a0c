"""An action of ROS 2 as its server sees it: the guard is the one client under the private name."""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatusArray
from rclpy.qos import QoSProfile, qos_profile_action_status_default
from rclpy.serialization import deserialize_message

from rtron.errors import WireError
from rtron.guard.action.ros2.endpoints import Cancelled
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.printable import shown
from rtron.guard.transport.ros2.action_server import READ_AHEAD, Around, goal_info, services_qos
from rtron.guard.transport.ros2.event_fd import Bell
from rtron.guard.transport.ros2.participants import Life
from rtron.vocabulary import REQUESTED, SECOND, TOLD, ActionEnd, end_name, names_node
from rtron.wire.ros2.endpoints import PARTICIPANT
from rtron.wire.ros2.service_endpoints import replies_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.action.ros2.endpoints import AnswerCancel, AnswerGoal, GoalMessage, HearsServer
    from rtron.wire.ros2.endpoints import Ros2Endpoint

log = logging.getLogger(__name__)

_LISTEN = {
    ActionEnd.FEEDBACK: QoSProfile(depth=READ_AHEAD),
    ActionEnd.STATUS: qos_profile_action_status_default,
}


class Back:
    """Asks the server, and tells `hears` what it says and whether it is there.

    It comes when all of its services answer and one planned node, whose name is its own, tells the
    status; it stays for as long as that one's endpoint is there, whoever comes beside it. Who
    answers a request, ROS 2 does not say: while others offer to serve, or to answer, the server is
    in doubt. DDS makes known who can answer before the answer can come.
    """

    def __init__(
        self, action: str, servers: tuple[str, ...], hears: HearsServer, around: Around
    ) -> None:
        self._action = action
        self._servers = servers
        self._hears = hears
        self._around = around
        self._clients: dict[ActionEnd, Any] = {}
        self._bells: list[Bell] = []
        self._subscriptions: list[Any] = []
        self._open_requests: dict[tuple[ActionEnd, int], Callable[[Any], None]] = {}
        self._server: Ros2Endpoint | None = None
        self._doubt = self._said = ""
        self._early: tuple[bytes, bytes] = (b"", b"")
        self._seldom = Seldom()

    def open(self) -> None:
        """Join the graph."""
        around = self._around
        for end in REQUESTED:
            client = around.node.create_client(
                around.service(end), end_name(self._action, end), qos_profile=services_qos()
            )
            self._clients[end] = client
            self._ring("client", client.handle, partial(self._answers, end))
        for end in TOLD:
            self._listen(end)
        for topic in (end_name(self._action, ActionEnd.STATUS), *map(self._replies, REQUESTED)):
            around.shared.graph.watch(topic)
        around.shared.graph.changed.append(self._look)

    def close(self) -> None:
        """Leave the graph."""
        self._around.shared.graph.changed.remove(self._look)
        for client in self._clients.values():
            self._around.node.destroy_client(client)
        for subscription in self._subscriptions:
            self._around.node.destroy_subscription(subscription)
        for bell in self._bells:
            bell.silence()
        self._clients.clear()

    def send_goal(self, goal: GoalMessage, answered: AnswerGoal) -> None:
        """Send a goal."""
        request = self._around.service(ActionEnd.SEND_GOAL).Request()
        request.goal_id.uuid = list(goal.id)
        request.goal = deserialize_message(bytes(goal), self._around.cls.Goal)

        def take(response: Any) -> None:  # noqa: ANN401 - a generated class
            answered(_stamp(response.stamp) if response.accepted else None)

        if not self._ask(ActionEnd.SEND_GOAL, request, take):
            self._around.shared.loop.call_at(
                self._around.shared.loop.now(), partial(answered, None)
            )

    def cancel(self, id: bytes, stamp: int, answered: AnswerCancel) -> None:
        """Send a cancel."""
        request = self._around.service(ActionEnd.CANCEL_GOAL).Request()
        request.goal_info = goal_info(id, stamp)

        def take(response: Any) -> None:  # noqa: ANN401 - a generated class
            goals = [(bytes(g.goal_id.uuid), _stamp(g.stamp)) for g in response.goals_canceling]
            answered(Cancelled(response.return_code, goals))

        self._ask(ActionEnd.CANCEL_GOAL, request, take)

    def get_result(self, id: bytes, answered: Callable[[int, object], None]) -> None:
        """Ask for a result."""
        request = self._around.service(ActionEnd.GET_RESULT).Request()
        request.goal_id.uuid = list(id)
        self._ask(ActionEnd.GET_RESULT, request, lambda r: answered(r.status, r.result))

    def _ask(self, end: ActionEnd, request: object, take: Callable[[Any], None]) -> bool:
        try:
            number = self._around.requests.request(self._clients[end].handle, request)
        except WireError as error:
            self._complain(str(error))
            return False
        self._open_requests[end, number] = take
        return True

    def _answers(self, end: ActionEnd, count: int) -> None:
        cls = self._around.service(end).Response
        for _ in range(count):
            try:
                taken = self._around.requests.take_response(self._clients[end].handle, cls)
            except WireError as error:
                self._complain(f"an answer is dropped: {error}")
                continue
            if taken is None:
                return
            number, response = taken
            take = self._open_requests.pop((end, number), None)
            if take and self._server:
                self._around.shared.graph.ask(self._replies(end))
                self._tell_doubt(self._listed())
                take(response)

    def _listen(self, end: ActionEnd) -> None:
        feedback = self._around.cls.Impl.FeedbackMessage
        subscription = self._around.node.create_subscription(
            feedback if end is ActionEnd.FEEDBACK else GoalStatusArray,
            end_name(self._action, end),
            lambda _message: None,
            _LISTEN[end],
            raw=True,
        )
        self._subscriptions.append(subscription)
        take = partial(self._messages, end, subscription.handle.pointer)
        self._ring("subscription", subscription.handle, take)

    def _messages(self, end: ActionEnd, pointer: int, count: int) -> None:
        for _ in range(count):
            taken = self._around.shared.rcl.take(pointer)
            if taken is None:
                return
            message, gid = taken
            if self._server and gid[:PARTICIPANT] == self._server.participant:
                self._hears.server_told(end, message)
            elif end is ActionEnd.STATUS:
                self._early = (gid[:PARTICIPANT], message)

    def _look(self) -> None:
        """Look who serves the action now; a doubt is told before goals can go to who comes."""
        listed = self._listed()
        server = self._found(listed)
        if self._server and (server is None or server.gid != self._server.gid):
            self._server = None
            self._open_requests.clear()
            self._hears.server_left()
        self._tell_doubt(listed)
        if server and self._server is None:
            self._come(server)

    def _tell_doubt(self, listed: list[Ros2Endpoint]) -> None:
        doubt = self._why_doubted(listed)
        self._say_once(doubt)
        if doubt != self._doubt:
            self._doubt = doubt
            self._hears.server_doubted(doubt)

    def _come(self, server: Ros2Endpoint) -> None:
        """Follow a server from now on."""
        self._server = server
        self._open_requests.clear()
        self._hears.server_came(server.node, server.gid)
        participant, message = self._early
        if participant == server.participant:
            self._hears.server_told(ActionEnd.STATUS, message)

    def _listed(self) -> list[Ros2Endpoint]:
        """Return everybody who lives and offers to serve."""
        return self._living(end_name(self._action, ActionEnd.STATUS))

    def _living(self, topic: str) -> list[Ros2Endpoint]:
        shared = self._around.shared
        ends = shared.graph.ends(topic).publishers
        return [each for each in ends if shared.lives.of(each.participant) is not Life.GONE]

    def _replies(self, end: ActionEnd) -> str:
        return replies_of(end_name(self._action, end))

    def _found(self, listed: list[Ros2Endpoint]) -> Ros2Endpoint | None:
        """Return the server in force while it is there, else the one that is in the right."""
        if not all(client.service_is_ready() for client in self._clients.values()):
            return None
        if self._server:
            stays = next((each for each in listed if each.gid == self._server.gid), None)
            if stays:
                return stays
        right = [each for each in listed if self._is_right(each)]
        return right[0] if len(right) == 1 else None

    def _is_right(self, end: Ros2Endpoint) -> bool:
        """Tell whether the plan means this one, and its name is its own."""
        planned = any(names_node(name, end.node) for name in self._servers)
        return planned and self._around.shared.owners.has(end.node, end.participant)

    def _why_doubted(self, listed: list[Ros2Endpoint]) -> str:
        """Return why somebody else than the server may answer, "" if nobody may."""
        if len(listed) > 1:
            return f"{len(listed)} nodes serve it: none is sent a goal"
        wrong = next((each for each in listed if each.node and not self._is_right(each)), None)
        if wrong:
            return f"{shown(wrong.node)} is not the planned server"
        serving = {each.participant for each in listed}
        ends = (each for end in REQUESTED for each in self._living(self._replies(end)))
        beside = next((each for each in ends if serving and each.participant not in serving), None)
        return f"{shown(beside.node) or 'a node'} answers in its place" if beside else ""

    def _ring(self, kind: str, handle: Any, take: Callable[[int], None]) -> None:  # noqa: ANN401
        bell = Bell(self._around.shared.loop, take)
        self._bells.append(bell)
        self._around.shared.rcl.notify(kind, handle, bell.fd)

    def _say_once(self, why: str) -> None:
        """Say what is wrong with who serves when that changes, and not too often."""
        if why != self._said and self._seldom.may_say("server", self._around.shared.loop.now()):
            self._said = why
            log.warning("%s: %s", self._action, why or "no other node serves it any more")

    def _complain(self, why: str) -> None:
        if self._seldom.may_say("complaint", self._around.shared.loop.now()):
            log.warning("%s: %s", self._action, why)


def _stamp(time: Any) -> int:  # noqa: ANN401 - builtin_interfaces/Time
    return int(time.sec) * SECOND + int(time.nanosec)
