"""What a client's cancel means, and what it does: in the queue here, and at the server."""

from collections.abc import Iterator

from rtron.guard.action.ros2.client_replies import CancelRequest, ClientReplies
from rtron.guard.action.ros2.endpoints import (
    TERMINATED,
    UNKNOWN_GOAL,
    CancelReply,
    CancelResponse,
)
from rtron.guard.action.ros2.goal_results import GoalTask
from rtron.guard.action.ros2.server_tracker import ServerTracker
from rtron.guard.core.pipeline import Pipeline
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros2.actions import CANCELED, NO_ID
from rtron.policies.goals.registry import GoalStage
from rtron.vocabulary import SECOND

_TIMEOUT = 5 * SECOND
_REASON = "cancelled by its client"


class ClientCancels:
    """Withdraws the goals that wait here, and asks the server to cancel the others."""

    def __init__(
        self,
        replies: ClientReplies,
        server: ServerTracker,
        pipeline: Pipeline,
        transport: Transport,
    ) -> None:
        self._replies = replies
        self._server = server
        self._pipeline = pipeline
        self._transport = transport

    def request(self, client: str, id: bytes, stamp: int, reply: CancelReply) -> None:
        """Cancel the goals of a client that its cancel means; answer when all is known of them."""
        now = self._transport.now()
        tasks = list(self._select(client, id, stamp))
        if not tasks and id != NO_ID:
            ended = self._replies.results.find(id, client, now)
            reply(CancelResponse(TERMINATED if ended else UNKNOWN_GOAL))
            return
        request = CancelRequest(reply)
        for task in tasks:
            self._cancel(task, request, now)
        request.close()
        self._transport.call_at(now + _TIMEOUT, request.expire)

    def _select(self, client: str, id: bytes, stamp: int) -> Iterator[GoalTask]:
        """Yield the goals of a client that its cancel means (action_msgs/CancelGoal)."""
        for task in self._replies.tasks.values():
            goal = task.goal
            all_of_them = id == NO_ID and not stamp
            is_selected = all_of_them or goal.id == id or (stamp and goal.stamp <= stamp)
            if is_selected and goal.client == client:
                yield task

    def _cancel(self, task: GoalTask, request: CancelRequest, now: int) -> None:
        goal = task.goal
        if goal.stage is GoalStage.SENT:
            self._replies.cancels.add(goal.id, request)
            self._server.cancel(goal.id)
            return
        task.is_cancelled = True
        request.add_canceling(goal.id, goal.stamp)
        if goal.message:
            self._pipeline.withdraw(goal.message, _REASON, now)
        else:
            self._replies.finish(task, CANCELED, reason=_REASON)
