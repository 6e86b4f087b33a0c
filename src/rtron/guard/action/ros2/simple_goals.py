"""Goals without an id in ROS 2, as on `goal_pose`: followed to the action's goal they become."""

from collections.abc import Callable
from typing import Protocol, runtime_checkable

from rtron.guard.action.ros1.simple_goals import FollowedStream
from rtron.guard.transport.common.protocol import Peer, Receive
from rtron.messages.ros2.actions import OVER, read_statuses
from rtron.vocabulary import ActionEnd, Mode, end_name

STATUS = "action_msgs/GoalStatusArray"


@runtime_checkable
class CarriesCancels(Protocol):
    """A transport on which the goals of an action that has no guard can be cancelled."""

    def canceller(self, node: str, action: str) -> Callable[[bytes], None]:
        """Return what asks an action's server to cancel a goal, as one of the guard's nodes."""
        ...


class FollowedRequests(FollowedStream):
    """A guarded stream whose `done` is an action of ROS 2, or a topic: its name does not tell.

    It is an action once one of the successors is seen to tell its status.
    """

    _is_action = False
    _ask_to_cancel: Callable[[bytes], None] | None = None

    @property
    def action(self) -> str:
        """The name of the action that the goals become, if it is one."""
        return self.stream.done or ""

    def _open_action(self) -> None:
        status = end_name(self.action, ActionEnd.STATUS)
        self._hear_successors(status, STATUS, self._connect_status)
        transport = self._transport
        if self.stream.mode is Mode.ENFORCE and isinstance(transport, CarriesCancels):
            self._ask_to_cancel = transport.canceller(self.nodes[0], self.action)

    def _connect_status(self, peer: Peer) -> Receive | None:
        take = super()._connect_status(peer)
        self._is_action = self._is_action or take is not None
        return take

    def _cancel(self, goal: bytes, why: str) -> None:
        super()._cancel(goal, why)
        if self._ask_to_cancel:
            self._ask_to_cancel(goal)

    def _look_for(self, said: int) -> None:
        if self._guarded or self._is_action:
            super()._look_for(said)

    def _status(self, message: bytes) -> None:
        told = self._read(read_statuses, message) or []
        self._following.sees(each.id for each in told)
        for each in told:
            if each.status in OVER:
                self._ended(each.id)
