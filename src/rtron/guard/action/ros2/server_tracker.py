"""An action of ROS 2 as its server sees it: what it is asked, answers and tells, and loses."""

import logging
from functools import partial

from rtron.errors import WireError
from rtron.guard.action.common.stream import ActionStream
from rtron.guard.action.ros2.cancel_requests import CancelRequests
from rtron.guard.action.ros2.client_replies import (
    RESULT_TIMEOUT,
    GoalResult,
    GoalTask,
    ResultCache,
    StatusPublisher,
)
from rtron.guard.action.ros2.endpoints import ActionListener, ActionTransport, CancelResponse
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import Observations
from rtron.guard.transport.common.protocol import Peer, Transport
from rtron.messages.ros2.actions import ABORTED, FINAL_STATES, UNKNOWN, feedback_id, read_statuses
from rtron.policies.goals.registry import MAX_GOALS, Goal, GoalStage
from rtron.policies.goals.status_list import LOST_TIMEOUT, TERMINAL_STATUSES, compare_status_list
from rtron.vocabulary import SECOND, Ros2ActionEntity, Stream

log = logging.getLogger(__name__)

_RESULT_RETRY = SECOND
_IN_PROGRESS, _OVER = 1, min(TERMINAL_STATUSES)


class ServerTracker(ActionStream, ActionListener):
    """Follows what becomes of goals at the server; each is answered once, by it or by the guard.

    While others serve beside it, the server is in doubt: they get what is asked, and answers may be
    theirs. No goal is sent then, and one that runs is followed by what the server itself tells.
    Whether it is cancelled says the plan's `audit.on_foreign`, since the audit brakes: by default
    it is, because an intruder that answers in the place of the server could make a goal that moves
    the robot look as if it were over. Cancels are always sent: they can only make less move.
    """

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        observations: Observations,
        handover: HandoverState,
        action_transport: ActionTransport,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, observations, handover, dry_run=dry_run)
        self.server = self.doubt = ""
        self._action_endpoints = action_transport.action_endpoints(self.spec, self.nodes[0], self)
        self._tasks: dict[bytes, GoalTask] = {}
        self._results = ResultCache()
        self._status_publisher = StatusPublisher(
            self._tasks.values,
            transport,
            partial(self._action_endpoints.publish, Ros2ActionEntity.STATUS),
        )
        self._cancel_requests = CancelRequests()
        self._incarnation = b""
        self._last_server = ""
        self._replied_without_server: list[bytes] = []

    # What becomes of the server

    def on_server_available(self, node: str, incarnation: bytes) -> None:
        """Learn that the server is there; another than before knows none of the goals."""
        is_same_server = self._incarnation in (b"", incarnation)
        self.server = self._last_server = node
        self._incarnation = incarnation
        if self._halt_reason:
            self.on_goal_stopped(node, self._halt_reason)
        if is_same_server:
            self._cancel_replied()
        else:
            self._fail_sent_goals()
        self._replied_without_server.clear()
        for task in list(self._tasks.values()):
            if task.is_accepted:
                self._request_result(task)
            if task.goal.cancel_reason:
                self._cancel_at_server(task.goal.id)
        self._status_publisher.publish_soon()
        self._resume_with_server()

    def on_server_lost(self) -> None:
        """Learn that the server is not there any more."""
        log.warning("%s: the server %s is gone", self.name, self.server)
        now = self._transport.now()
        self.server, self._status_publisher.server_statuses = "", {}
        self._await_server(now)
        for goal in self.goals:
            if not goal.client:
                self._end(goal, now)
        self._transport.call_at(now + LOST_TIMEOUT, self._reply_without_server)

    def on_server_doubt(self, reason: str) -> None:
        """Send no goals while somebody else may take them; then go on."""
        self.doubt = reason
        if self.server and not reason:
            for task in list(self._tasks.values()):
                if task.is_accepted:
                    self._request_result(task)
            self._resume_with_server()

    def _free_turn(self) -> None:
        """Let the next goal go, once it is certain to whom."""
        if self.doubt and not self.dry_run:
            self._is_server_absent = True
        else:
            super()._free_turn()

    def _reply_without_server(self) -> None:
        """Answer the goals whose server has not been found again."""
        if not self.server:
            sent = (goal for goal in self.goals if goal.stage is GoalStage.SENT)
            self._replied_without_server += [goal.id for goal in sent]
            del self._replied_without_server[:-MAX_GOALS]
            self._fail_sent_goals()

    def _cancel_replied(self) -> None:
        """Cancel what was answered while the server was away: it may have gone on with it."""
        for id in self._replied_without_server:
            self._cancel_at_server(id)

    def _fail_sent_goals(self) -> None:
        """Answer the goals that went with their server."""
        for task in list(self._tasks.values()):
            if task.goal.stage is GoalStage.SENT:
                self._finish(task, ABORTED, reason="the server has lost it")
                self._end_turn(task.goal)

    # What it answers

    def _send_goal(self, goal: Goal) -> None:
        task = self._tasks[goal.id]
        self.goals.mark_sent(goal, self._transport.now())
        self._goal_handover.store_soon()
        on_reply = partial(self._on_goal_reply, task)
        if self._is_server_ready() or self.dry_run:
            self._action_endpoints.send_goal(goal.message, on_reply)  # type: ignore[arg-type]
        else:
            self._transport.call_at(self._transport.now(), partial(on_reply, None))

    def _on_goal_reply(self, task: GoalTask, stamp: int | None) -> None:
        """Take the server's answer to a goal."""
        if self._tasks.get(task.goal.id) is not task:
            if stamp is not None:
                self._cancel_at_server(task.goal.id)
        elif stamp is None:
            if self.doubt:
                self._cancel_at_server(task.goal.id)
            self._finish(task, ABORTED, reason="the server has rejected it")
            self._end_turn(task.goal)
        elif not task.is_accepted:
            task.is_accepted = True
            task.accept(stamp)
            self._request_result(task)
            if task.must_cancel:
                self._cancel_at_server(task.goal.id)
            self._status_publisher.publish_soon()

    def _request_result(self, task: GoalTask) -> None:
        self._action_endpoints.get_result(task.goal.id, partial(self._on_result, task))

    def _await_late_result(self, goal: Goal, status: int) -> None:
        """Ask once more for the result of a goal that is over, then do without: it may be lost."""
        task, now = self._tasks.get(goal.id), self._transport.now()
        if task and not task.is_over:
            task.is_over = True
            self._transport.call_at(now + _RESULT_RETRY, partial(self._request_result_again, task))
            self._transport.call_at(
                now + LOST_TIMEOUT, partial(self._finish_without_result, task, status)
            )

    def _request_result_again(self, task: GoalTask) -> None:
        if self._tasks.get(task.goal.id) is task:
            self._request_result(task)

    def _finish_without_result(self, task: GoalTask, status: int) -> None:
        if self._tasks.get(task.goal.id) is task:
            self._finish(task, status, reason="its result does not come")

    def _on_result(self, task: GoalTask, status: int, result: object) -> None:
        goal = task.goal
        if self._tasks.get(goal.id) is not task or not self._is_trusted_result(goal, status):
            return
        if self.measurement:
            self.measurement.finish_goal(goal.id, self._transport.now())
        if status == UNKNOWN:
            self._finish(task, ABORTED, reason="the server has lost it")
        else:
            self._finish(task, status, result)
        self._end_turn(goal)

    def _is_trusted_result(self, goal: Goal, status: int) -> bool:
        """Tell whether a result is the server's: in doubt, if the server itself has told the end.

        What is not believed is asked for once more, when the server has told or is alone again.
        """
        listed_status = self._status_publisher.server_statuses.get(goal.id)
        return not self.doubt or (listed_status is not None and listed_status.status == status)

    def _cancel_at_server(self, id: bytes) -> None:
        """Ask the server to cancel a goal, be it in doubt or out of sight.

        One that it is about to answer is cancelled after that; in doubt at once, too, since that
        answer may be somebody else's.
        """
        task = self._tasks.get(id)
        is_pending = task is not None and not task.is_accepted
        if task and is_pending:
            task.must_cancel = True
        if not self.dry_run and (self.doubt or not is_pending):
            self._action_endpoints.cancel(id, 0, partial(self._on_cancel_reply, id))

    def _on_cancel_reply(self, id: bytes, response: CancelResponse) -> None:
        goal = self.goals.find(id)
        is_canceling = any(each == id for each, _ in response.goals)
        if goal and goal.cancel_reason and not is_canceling:
            log.error("%s: the server does not cancel %s", self.name, self._goal_label(goal))
        self._cancel_requests.resolve(id, goal.stamp if goal else 0, is_canceling=is_canceling)

    # What it tells

    def on_server_message(self, end: Ros2ActionEntity, message: bytes) -> None:
        """Take what the server tells on its topics."""
        try:
            if end is Ros2ActionEntity.STATUS:
                self._on_status(message)
            else:
                self._on_feedback(message)
        except WireError as error:
            self._log_problem(
                Peer(self.server, self._action_endpoints.type_info), f"cannot be read: {error}"
            )

    def _on_feedback(self, message: bytes) -> None:
        """Tell the goal's client; what overtakes the result comes after the goal is over."""
        id = feedback_id(message)
        goal = self.goals.find(id)
        flow = goal.flow if goal else self._results.flow_of(id)
        self._action_endpoints.publish(Ros2ActionEntity.FEEDBACK, message, [flow] if flow else [])

    def _on_status(self, message: bytes) -> None:
        now = self._transport.now()
        statuses = {status.id: status for status in read_statuses(message)}
        self._status_publisher.server_statuses = statuses if self.server else {}
        states = {
            id: _OVER if status.status in FINAL_STATES else _IN_PROGRESS
            for id, status in statuses.items()
        }
        changes = compare_status_list(self.goals, states, now)
        for id in changes.resurrected:
            self._cancel_at_server(id)
        for goal in changes.discovered:
            self._on_foreign_goal(goal, now)
        for goal in changes.finished:
            self._await_late_result(goal, statuses[goal.id].status)
            if not goal.client:
                self._end(goal, now)
            self._end_turn(goal)
        for goal in self.goals:
            if not goal.client and states.get(goal.id, _OVER) == _OVER:
                self._end(goal, now)
                self._end_turn(goal)
        self._status_publisher.publish()

    # How a goal ends

    def _finish(
        self, task: GoalTask, status: int, result: object | None = None, *, reason: str = ""
    ) -> None:
        """End a goal and answer its client; `reason` says why the guard does, not the server."""
        goal, now = task.goal, self._transport.now()
        self._end(goal, now)
        self._goal_handover.store()
        if reason:
            log.info("%s: %s: %s", self.name, self._goal_label(goal), reason)
        if not task.is_acknowledged:
            task.reject()
            task.reply_with_result(UNKNOWN, None)
            return
        cached = GoalResult(
            goal.client, goal.flow, goal.stamp, status, result, now + RESULT_TIMEOUT
        )
        self._results.add(goal.id, cached)
        task.reply_with_result(status, result)
        if reason:
            self._status_publisher.add_ended(task, status)

    def _end(self, goal: Goal, now: int) -> None:
        self._tasks.pop(goal.id, None)
        self._cancel_requests.resolve(goal.id, goal.stamp, is_canceling=False)
        super()._end(goal, now)

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        doubt = {"server in doubt": self.doubt} if self.doubt else {}
        return super().details | doubt

    def _refusal_reason(self, goal: Goal) -> str:
        in_doubt = self.server and self.doubt and not self.dry_run
        return self.doubt if in_doubt else super()._refusal_reason(goal)

    def _server_node(self) -> str:
        """Return the server, also one out of sight: what it is to be kept from, it may go on to."""
        return self.server or self._last_server

    def _is_server_ready(self) -> bool:
        return bool(self.server) and not self.doubt

    def _is_server_visible(self) -> bool:
        return bool(self.server)

    def _goal_label(self, goal: Goal) -> str:
        return f"goal {goal.id.hex()} of {goal.client or 'the server itself'}"
