"""The goals of an action of ROS 2 without a guard, as its status tells them, for `goal_pose`."""

from typing import TYPE_CHECKING

from rtron.guard.action.common.problem_log import ProblemLog
from rtron.guard.action.common.simple_goals import SimpleGoalStream
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.transport.common.protocol import MessageHandler, Peer
from rtron.messages.ros2.actions import FINAL_STATES, read_statuses
from rtron.vocabulary import Mode, Ros2ActionEntity, ros2_entity_name

if TYPE_CHECKING:
    from collections.abc import Callable

STATUS = "action_msgs/GoalStatusArray"


class ActionStatusObserver:
    """Subscribes to the status of what `done` names, which may be an action or a topic.

    It is an action once one of the successors is seen to publish its status.
    """

    sees_goals = False

    def __init__(self, action: str, context: StreamContext) -> None:
        self._action = action
        self._transport = context.transport
        self._request_cancel: Callable[[bytes], None] | None = None

    def open(self, stream: SimpleGoalStream) -> None:
        """Join the graph."""
        self._stream = stream
        self._problems = ProblemLog(stream.spec.topic, self._transport)
        status = ros2_entity_name(self._action, Ros2ActionEntity.STATUS)
        stream.endpoints.subscribe_successors(self._action, "", lambda _: stream.on_action_done)
        stream.endpoints.subscribe_successors(status, STATUS, self._connect_status)
        goal_canceller = getattr(self._transport, "goal_canceller", None)  # a transport of ROS 2
        if stream.spec.mode is Mode.ENFORCE and goal_canceller:
            self._request_cancel = goal_canceller(stream.nodes[0], self._action)

    def expect_goal(self) -> None:
        """Nobody else waits."""

    def stop_expecting(self, stream: SimpleGoalStream) -> None:
        """Let the next message go."""
        stream.on_action_done()

    def cancel(self, goal: bytes, why: str) -> None:
        """Send a cancel to the server."""
        del why
        if self._request_cancel:
            self._request_cancel(goal)

    def _connect_status(self, peer: Peer) -> MessageHandler:
        self.sees_goals = True
        return self._problems.decoding_receiver(peer, self._on_status)

    def _on_status(self, message: bytes) -> None:
        statuses = read_statuses(message)
        self._stream.goal_tracker.update_goals(each.id for each in statuses)
        for each in statuses:
            if each.status in FINAL_STATES:
                self._stream.on_goal_end(each.id)
