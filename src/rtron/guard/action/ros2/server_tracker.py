"""An action of ROS 2 as its server sees it: its requests, replies and topics, and its absence."""

import logging
from functools import partial

from rtron.errors import WireError
from rtron.guard.action.common.action_goals import ActionGoals
from rtron.guard.action.common.problem_log import ProblemLog
from rtron.guard.action.ros2.client_replies import ClientReplies
from rtron.guard.action.ros2.endpoints import ActionEndpoints, CancelResponse
from rtron.guard.action.ros2.goal_results import GoalTask
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.messages.ros2.actions import ABORTED, FINAL_STATES, UNKNOWN, feedback_id, read_statuses
from rtron.policies.goals.registry import MAX_GOALS, Goal, GoalStage
from rtron.policies.goals.status_list import LOST_TIMEOUT, TERMINAL_STATUSES, compare_status_list
from rtron.vocabulary import SECOND, Ros2ActionEntity

log = logging.getLogger(__name__)

_RESULT_RETRY = SECOND
_IN_PROGRESS, _OVER = 1, min(TERMINAL_STATUSES)


class ServerTracker:
    """Follows what becomes of goals at the server; each is answered once, by it or by the guard.

    While others serve beside it, the server is in doubt: they get what is asked, and answers may be
    theirs. No goal is sent then, and one that runs is followed by what the server itself tells.
    Whether it is cancelled says the plan's `audit.on_foreign`, since the audit brakes: by default
    it is, because an intruder that answers in the place of the server could make a goal that moves
    the robot look as if it were over. Cancels are always sent: they can only make less move.
    """

    def __init__(
        self,
        endpoints: ActionEndpoints,
        goals: ActionGoals,
        replies: ClientReplies,
        problems: ProblemLog,
        context: StreamContext,
    ) -> None:
        self.node = self.doubt = ""
        """The node that serves the action, or has last served it, and why it is in doubt."""
        self.is_available = False
        self._endpoints = endpoints
        self._goals = goals
        self._replies = replies
        self._problems = problems
        self._transport = context.transport
        self._dry_run = context.dry_run
        self._incarnation = b""
        self._replied_without_server: list[bytes] = []

    @property
    def is_ready(self) -> bool:
        """Whether the server is there, and nobody else beside it."""
        return self.is_available and not self.doubt

    @property
    def may_be_sent_goals(self) -> bool:
        """Whether it is certain to whom a goal would go; a dry run lets all pass."""
        return self._dry_run or not self.doubt

    # Whether the server is there

    def on_available(self, node: str, incarnation: bytes) -> None:
        """Learn that the server is there; another than before knows none of the goals."""
        is_same_server = self._incarnation in (b"", incarnation)
        self.node, self.is_available, self._incarnation = node, True, incarnation
        if is_same_server:
            self._cancel_replied()
        else:
            self._fail_sent_goals()
        self._replied_without_server.clear()
        for task in list(self._replies.tasks.values()):
            if task.is_accepted:
                self._request_result(task)
            if task.goal.cancel_reason:
                self.cancel(task.goal.id)
        self._replies.status.publish_soon()
        self._resume()

    def on_lost(self) -> None:
        """Learn that the server is not there any more."""
        log.warning("%s: the server %s is gone", self._goals.name, self.node)
        now = self._transport.now()
        self.is_available, self._replies.status.server_statuses = False, {}
        self._goals.queue.await_server(now)
        for goal in self._goals.registry:
            if not goal.client:
                self._replies.end(goal, now)
        self._transport.call_at(now + LOST_TIMEOUT, self.finish_without_server)

    def on_doubt(self, reason: str) -> None:
        """Send no goals while somebody else may take them; then go on."""
        self.doubt = reason
        if self.is_available and not reason:
            for task in list(self._replies.tasks.values()):
                if task.is_accepted:
                    self._request_result(task)
            self._resume()

    def _resume(self) -> None:
        if self.is_ready:
            self._goals.queue.resume()

    def finish_without_server(self) -> None:
        """Answer the goals whose server has not been found again."""
        if not self.is_available:
            sent = (goal for goal in self._goals.registry if goal.stage is GoalStage.SENT)
            self._replied_without_server += [goal.id for goal in sent]
            del self._replied_without_server[:-MAX_GOALS]
            self._fail_sent_goals()

    def _cancel_replied(self) -> None:
        """Cancel what was answered while the server was away: it may have gone on with it."""
        for id in self._replied_without_server:
            self.cancel(id)

    def _fail_sent_goals(self) -> None:
        """Answer the goals that went with their server."""
        for task in list(self._replies.tasks.values()):
            if task.goal.stage is GoalStage.SENT:
                self._replies.finish(task, ABORTED, reason="the server has lost it")
                self._goals.queue.end_turn(task.goal)

    # Its replies

    def send(self, goal: Goal) -> None:
        """Send a goal to the server; one that may not go now counts as rejected."""
        task = self._replies.tasks[goal.id]
        self._goals.registry.mark_sent(goal, self._transport.now())
        self._goals.store_soon()
        on_reply = partial(self._on_goal_reply, task)
        if self.is_ready or self._dry_run:
            self._endpoints.send_goal(goal.message, on_reply)  # type: ignore[arg-type]
        else:
            self._transport.call_at(self._transport.now(), partial(on_reply, None))

    def _on_goal_reply(self, task: GoalTask, stamp: int | None) -> None:
        """Take the server's answer to a goal."""
        if self._replies.tasks.get(task.goal.id) is not task:
            if stamp is not None:
                self.cancel(task.goal.id)
        elif stamp is None:
            if self.doubt:
                self.cancel(task.goal.id)
            self._replies.finish(task, ABORTED, reason="the server has rejected it")
            self._goals.queue.end_turn(task.goal)
        elif not task.is_accepted:
            task.is_accepted = True
            self._replies.accept(task, stamp)
            self._request_result(task)
            if task.must_cancel:
                self.cancel(task.goal.id)

    def _request_result(self, task: GoalTask) -> None:
        self._endpoints.get_result(task.goal.id, partial(self._on_result, task))

    def _await_late_result(self, goal: Goal, status: int) -> None:
        """Ask once more for the result of a goal that is over, then do without: it may be lost."""
        task, now = self._replies.tasks.get(goal.id), self._transport.now()
        if task and not task.is_over:
            task.is_over = True
            self._transport.call_at(now + _RESULT_RETRY, partial(self._request_result_again, task))
            self._transport.call_at(
                now + LOST_TIMEOUT, partial(self._finish_without_result, task, status)
            )

    def _request_result_again(self, task: GoalTask) -> None:
        if self._replies.tasks.get(task.goal.id) is task:
            self._request_result(task)

    def _finish_without_result(self, task: GoalTask, status: int) -> None:
        if self._replies.tasks.get(task.goal.id) is task:
            self._replies.finish(task, status, reason="its result does not come")

    def _on_result(self, task: GoalTask, status: int, result: object) -> None:
        goal = task.goal
        if self._replies.tasks.get(goal.id) is not task or not self._is_trusted_result(
            goal, status
        ):
            return
        self._goals.on_result(goal.id)
        if status == UNKNOWN:
            self._replies.finish(task, ABORTED, reason="the server has lost it")
        else:
            self._replies.finish(task, status, result)
        self._goals.queue.end_turn(goal)

    def _is_trusted_result(self, goal: Goal, status: int) -> bool:
        """Tell whether a result is the server's: in doubt, if the server itself has told the end.

        What is not believed is asked for once more, when the server has told or is alone again.
        """
        listed_status = self._replies.status.server_statuses.get(goal.id)
        return not self.doubt or (listed_status is not None and listed_status.status == status)

    def cancel(self, id: bytes) -> None:
        """Ask the server to cancel a goal, be it in doubt or out of sight.

        One that it is about to answer is cancelled after that; in doubt at once, too, since that
        answer may be somebody else's.
        """
        task = self._replies.tasks.get(id)
        is_pending = task is not None and not task.is_accepted
        if task and is_pending:
            task.must_cancel = True
        if not self._dry_run and (self.doubt or not is_pending):
            self._endpoints.cancel(id, 0, partial(self._on_cancel_reply, id))

    def _on_cancel_reply(self, id: bytes, response: CancelResponse) -> None:
        goal = self._goals.registry.find(id)
        is_canceling = any(each == id for each, _ in response.goals)
        if goal and goal.cancel_reason and not is_canceling:
            log.error(
                "%s: the server does not cancel %s", self._goals.name, self._goals.label(goal)
            )
        self._replies.cancels.resolve(id, goal.stamp if goal else 0, is_canceling=is_canceling)

    # Its topics

    def on_message(self, end: Ros2ActionEntity, message: bytes) -> None:
        """Take what the server publishes on its topics."""
        try:
            if end is Ros2ActionEntity.STATUS:
                self._on_status(message)
            else:
                self._replies.publish_feedback(feedback_id(message), message)
        except WireError as error:
            self._problems.log(self.node, f"cannot be read: {error}")

    def _on_status(self, message: bytes) -> None:
        now = self._transport.now()
        statuses = {status.id: status for status in read_statuses(message)}
        self._replies.status.server_statuses = statuses if self.is_available else {}
        states = {
            id: _OVER if status.status in FINAL_STATES else _IN_PROGRESS
            for id, status in statuses.items()
        }
        changes = compare_status_list(self._goals.registry, states, now)
        for id in changes.resurrected:
            self.cancel(id)
        for goal in changes.discovered:
            self._goals.start_server_goal(goal, now)
        for goal in changes.finished:
            self._await_late_result(goal, statuses[goal.id].status)
            if not goal.client:
                self._replies.end(goal, now)
            self._goals.queue.end_turn(goal)
        for goal in self._goals.registry:
            if not goal.client and states.get(goal.id, _OVER) == _OVER:
                self._replies.end(goal, now)
                self._goals.queue.end_turn(goal)
        self._replies.status.publish()
