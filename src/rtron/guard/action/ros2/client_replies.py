"""What the clients of an action get from the guard: answers to their requests, and the status."""

import logging
from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.action.common.action_goals import ActionGoals
from rtron.guard.action.ros2.endpoints import (
    NONE,
    REJECTED,
    ActionEndpoints,
    CancelReply,
    CancelResponse,
    GoalReply,
)
from rtron.guard.action.ros2.goal_results import (
    RESULT_TIMEOUT,
    GoalResult,
    GoalTask,
    ResultCache,
    ResultRequestHandover,
)
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.core.timers import DelayedCall
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros2.actions import ACCEPTED, UNKNOWN, GoalStatus, status_array
from rtron.policies.goals.registry import Goal, GoalStage
from rtron.vocabulary import SECOND, Ros2ActionEntity

if TYPE_CHECKING:
    from rtron.guard.transport.ros2.action_server import ResultResponder

log = logging.getLogger(__name__)


class CancelRequest:
    """Gathers the answers for the goals of one cancel, and answers when the last has come.

    A client's cancel never goes to the server as it is: by a stamp, or without an id, it would
    mean the goals of others too.
    """

    def __init__(self, reply: CancelReply) -> None:
        self._reply: CancelReply | None = reply
        self._pending: set[bytes] = set()
        self._canceling: list[tuple[bytes, int]] = []
        self._has_goals = self._is_closed = False

    def add_canceling(self, id: bytes, stamp: int) -> None:
        """Note a goal that will end."""
        self._has_goals = True
        self._canceling.append((id, stamp))

    def add_pending(self, id: bytes) -> None:
        """Wait for what becomes of a goal."""
        self._has_goals = True
        self._pending.add(id)

    def resolve(self, id: bytes, stamp: int, *, is_canceling: bool) -> None:
        """Learn whether a goal that is waited for will end."""
        if id in self._pending:
            self._pending.discard(id)
            if is_canceling:
                self.add_canceling(id, stamp)
            self._reply_if_resolved()

    def close(self) -> None:
        """Know all goals of the cancel; answer as soon as none is open."""
        self._is_closed = True
        self._reply_if_resolved()

    def expire(self) -> None:
        """Answer with what is known."""
        self._pending.clear()
        self._is_closed = True
        self._reply_if_resolved()

    def _reply_if_resolved(self) -> None:
        if self._reply and self._is_closed and not self._pending:
            reply, self._reply = self._reply, None
            is_rejected = self._has_goals and not self._canceling
            reply(CancelResponse(REJECTED if is_rejected else NONE, tuple(self._canceling)))


class CancelRequests:
    """The gatherings that wait for what becomes of a goal."""

    def __init__(self) -> None:
        self._waiting: dict[bytes, list[CancelRequest]] = defaultdict(list)

    def add(self, id: bytes, request: CancelRequest) -> None:
        """Let a gathering wait for what becomes of a goal."""
        request.add_pending(id)
        self._waiting[id].append(request)

    def resolve(self, id: bytes, stamp: int, *, is_canceling: bool) -> None:
        """Tell all that wait for a goal whether it will end."""
        for request in self._waiting.pop(id, ()):
            request.resolve(id, stamp, is_canceling=is_canceling)


_MAX_ENDED = 1024
_PUBLISH_DELAY = SECOND // 50
_RETRY = SECOND // 10


class StatusPublisher:
    """Publishes what the server lists, what waits here, and what ended here.

    Soon after something has changed, and once for many changes.
    """

    def __init__(
        self,
        tasks: Callable[[], Iterable[GoalTask]],
        transport: Transport,
        publish: Callable[[bytes], None],
    ) -> None:
        self.server_statuses: dict[bytes, GoalStatus] = {}
        """What the server has told last."""
        self._tasks = tasks
        self._transport = transport
        self._publish = publish
        self._ended_goals: deque[tuple[int, GoalStatus]] = deque(maxlen=_MAX_ENDED)
        self._delayed_publish = DelayedCall(transport, _PUBLISH_DELAY, self.publish)

    def add_ended(self, task: GoalTask, status: int) -> None:
        """List a goal that ended here, whatever the server says of it."""
        goal_status = GoalStatus(task.goal.id, task.goal.stamp, status)
        self._ended_goals.append((self._transport.now() + RESULT_TIMEOUT, goal_status))
        self.publish_soon()

    def publish_soon(self) -> None:
        """Tell the clients what has changed here."""
        self._delayed_publish.schedule()

    def publish(self) -> None:
        """Tell the clients of every goal."""
        now = self._transport.now()
        while self._ended_goals and self._ended_goals[0][0] <= now:
            self._ended_goals.popleft()
        statuses = dict(self.server_statuses)
        for task in self._tasks():
            goal = task.goal
            if goal.client and task.is_acknowledged and goal.id not in statuses:
                statuses[goal.id] = GoalStatus(goal.id, goal.stamp, ACCEPTED)
        statuses |= {goal_status.id: goal_status for _, goal_status in self._ended_goals}
        self._publish(status_array(statuses.values()))


class ClientReplies:
    """Answers each request of a client once: for a goal, its result and its cancel."""

    def __init__(
        self, endpoints: ActionEndpoints, goals: ActionGoals, context: StreamContext
    ) -> None:
        self.tasks: dict[bytes, GoalTask] = {}
        self.results = ResultCache()
        self.cancels = CancelRequests()
        self.status = StatusPublisher(
            self.tasks.values,
            context.transport,
            partial(endpoints.publish, Ros2ActionEntity.STATUS),
        )
        self._endpoints = endpoints
        self._goals = goals
        self._transport = context.transport
        self._handover = ResultRequestHandover(goals.name, self.tasks, context)

    def restore(self) -> None:
        """Go on with the goals of the guard before, and with who waits for their results."""
        for goal in self._goals.restore():
            if goal.client:
                self.tasks[goal.id] = GoalTask(goal, is_accepted=goal.stage is GoalStage.SENT)
        self._handover.restore(self._endpoints.restore_reply)

    def add(self, goal: Goal, reply: GoalReply) -> GoalTask:
        """Take a goal whose client waits to know whether it is accepted."""
        self._goals.registry.add(goal)
        task = self.tasks[goal.id] = GoalTask(goal, reply)
        return task

    def accept(self, task: GoalTask, stamp: int) -> None:
        """Tell a client since when its goal is accepted."""
        task.accept(stamp)
        self.status.publish_soon()

    def request_result(self, id: bytes, client: str, reply: "ResultResponder") -> None:
        """Take a request for a goal's result; nobody but its client gets it."""
        task = self.tasks.get(id)
        if task and task.goal.client == client:
            if task.add_result_request(reply):
                self._handover.store_soon()
            else:
                reply(UNKNOWN, None)
        elif cached := self.results.find(id, client, self._transport.now()):
            reply(cached.status, cached.result)
        else:
            reply(UNKNOWN, None)

    def finish(
        self, task: GoalTask, status: int, result: object | None = None, *, reason: str = ""
    ) -> None:
        """End a goal and answer its client; `reason` says why the guard does, not the server.

        While its client cannot be told, it goes on: the next guard would not know of an answer that
        is lost with this one.
        """
        if task.is_held:
            return
        goal, now = task.goal, self._transport.now()
        if not task.is_reachable:
            task.is_held = True
            again = partial(self._finish_held, task, status, result, reason=reason)
            self._transport.call_at(now + _RETRY, again)
            return
        self.end(goal, now)
        self._goals.store()
        if reason:
            log.info("%s: %s: %s", self._goals.name, self._goals.label(goal), reason)
        if not task.is_acknowledged:
            task.reject()
            task.reply_with_result(UNKNOWN, None)
            return
        cached = GoalResult(goal.client, goal.flow, status, result, now + RESULT_TIMEOUT)
        self.results.add(goal.id, cached)
        task.reply_with_result(status, result)
        if reason:
            self.status.add_ended(task, status)

    def _finish_held(
        self, task: GoalTask, status: int, result: object | None, *, reason: str
    ) -> None:
        task.is_held = False
        if self.tasks.get(task.goal.id) is task:
            self.finish(task, status, result, reason=reason)

    def end(self, goal: Goal, now: int) -> None:
        """Know that a goal is over, and no cancel of it is answered any more."""
        self.tasks.pop(goal.id, None)
        self.cancels.resolve(goal.id, goal.stamp, is_canceling=False)
        self._goals.end(goal, now)

    def publish_feedback(self, id: bytes, message: bytes) -> None:
        """Tell the goal's client; what overtakes the result comes after the goal is over."""
        goal = self._goals.registry.find(id)
        flow = goal.flow if goal else self.results.flow_of(id)
        self._endpoints.publish(Ros2ActionEntity.FEEDBACK, message, [flow] if flow else [])
