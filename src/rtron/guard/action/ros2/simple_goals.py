"""Goals without an id in ROS 2, as on `goal_pose`: followed to the action's goal they become."""

from collections.abc import Callable
from typing import Protocol, runtime_checkable

from rtron.guard.action.ros1.simple_goals import SimpleGoalStream
from rtron.guard.transport.common.protocol import MessageHandler, Peer
from rtron.messages.ros2.actions import FINAL_STATES, read_statuses
from rtron.vocabulary import Mode, Ros2ActionEntity, ros2_entity_name

STATUS = "action_msgs/GoalStatusArray"


@runtime_checkable
class CancelTransport(Protocol):
    """A transport on which the goals of an action that has no guard can be cancelled."""

    def goal_canceller(self, node: str, action: str) -> Callable[[bytes], None]:
        """Return what asks an action's server to cancel a goal, as one of the guard's nodes."""
        ...


class Ros2SimpleGoalStream(SimpleGoalStream):
    """A guarded stream whose `done` is an action of ROS 2, or a topic: its name does not tell.

    It is an action once one of the successors is seen to tell its status.
    """

    _is_action = False
    _request_cancel: Callable[[bytes], None] | None = None

    @property
    def action(self) -> str:
        """The name of the action that the goals become, if it is one."""
        return self.spec.done or ""

    def _subscribe_action(self) -> None:
        status = ros2_entity_name(self.action, Ros2ActionEntity.STATUS)
        self._subscribe_successors(status, STATUS, self._connect_status)
        transport = self._transport
        if self.spec.mode is Mode.ENFORCE and isinstance(transport, CancelTransport):
            self._request_cancel = transport.goal_canceller(self.nodes[0], self.action)

    def _connect_status(self, peer: Peer) -> MessageHandler | None:
        take = super()._connect_status(peer)
        self._is_action = self._is_action or take is not None
        return take

    def _cancel_goal(self, goal: bytes, why: str) -> None:
        super()._cancel_goal(goal, why)
        if self._request_cancel:
            self._request_cancel(goal)

    def _check_goal_appeared(self, sent_count: int) -> None:
        if self._guarded_action or self._is_action:
            super()._check_goal_appeared(sent_count)

    def _on_status(self, message: bytes) -> None:
        statuses = self._decode(read_statuses, message) or []
        self._goal_matcher.update_goals(each.id for each in statuses)
        for each in statuses:
            if each.status in FINAL_STATES:
                self._on_goal_end(each.id)
