"""The results of goals: who waits for one, and which are kept for those who ask late."""

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rtron.guard.action.ros2.endpoints import MAX_PENDING_RESULTS, GoalReply
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.core.timers import DelayedCall
from rtron.policies.goals.registry import Goal
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from rtron.guard.transport.ros2.action_server import ResultResponder

RESULT_TIMEOUT = 10 * SECOND
"""As long as rcl_action's servers keep them."""
MAX_RESULTS = 256
_STORE_DELAY = SECOND // 100
_MAX_STORED = 256


@dataclass(slots=True, eq=False)
class GoalTask:
    """A goal, and who waits for what.

    `goal_reply` answers the client while it does not know yet whether its goal is accepted.
    `is_accepted` tells whether the server has it, `is_cancelled` that its client has given it up,
    `must_cancel` that the server is to cancel it as soon as it has it, `is_over` that it says that
    the goal has ended, `is_held` that its end is known and its client cannot be told yet.
    """

    goal: Goal
    goal_reply: GoalReply | None = None
    is_accepted: bool = False
    is_cancelled: bool = False
    must_cancel: bool = False
    is_over: bool = False
    is_held: bool = False
    result_replies: list["ResultResponder"] = field(default_factory=list)

    @property
    def is_acknowledged(self) -> bool:
        """Whether the client knows that its goal is accepted."""
        return self.goal_reply is None

    def accept(self, stamp: int) -> None:
        """Tell the client since when its goal is accepted, if it does not know."""
        reply, self.goal_reply = self.goal_reply, None
        if reply:
            self.goal.stamp = stamp
            reply(stamp)

    def reject(self) -> None:
        """Tell the client that its goal is not accepted, if it does not know better."""
        reply, self.goal_reply = self.goal_reply, None
        if reply:
            reply(None)

    @property
    def is_reachable(self) -> bool:
        """Whether all who wait for the result can be told."""
        return all(reply.is_reachable for reply in self.result_replies)

    def add_result_request(self, reply: "ResultResponder") -> bool:
        """Let a request wait for the result; False if too many do."""
        has_room = len(self.result_replies) < MAX_PENDING_RESULTS
        if has_room:
            self.result_replies.append(reply)
        return has_room

    def reply_with_result(self, status: int, result: object | None) -> None:
        """Answer all who wait for the result."""
        replies, self.result_replies = self.result_replies, []
        for reply in replies:
            reply(status, result)


@dataclass(frozen=True, slots=True)
class GoalResult:
    """How a goal of a client has ended; no result is an empty one."""

    client: str
    flow: str
    status: int
    result: object | None
    expires_at: int


class ResultCache:
    """The newest results by the goal's id."""

    def __init__(self) -> None:
        self._results: OrderedDict[bytes, GoalResult] = OrderedDict()

    def add(self, id: bytes, result: GoalResult) -> None:
        """Keep a result until its time."""
        self._results[id] = result
        if len(self._results) > MAX_RESULTS:
            self._results.popitem(last=False)

    def flow_of(self, id: bytes) -> str:
        """Return the flow of a goal that is over, or nothing."""
        result = self._results.get(id)
        return result.flow if result else ""

    def find(self, id: bytes, client: str, now: int) -> GoalResult | None:
        """Return the result of a client's goal; what has been kept long enough is forgotten."""
        while self._results and next(iter(self._results.values())).expires_at <= now:
            self._results.popitem(last=False)
        result = self._results.get(id)
        return result if result and result.client == client else None


class ResultRequestHandover:
    """Leaves the open requests for results to the next guard.

    A client asks for a result once and waits, whoever serves it: a guard that takes the place of
    another can answer, if it knows where.
    """

    def __init__(
        self, action: str, tasks: Mapping[bytes, GoalTask], context: StreamContext
    ) -> None:
        self._key = f"results {action}"
        self._tasks = tasks
        self._handover = context.handover
        self._delayed_store = DelayedCall(context.transport, _STORE_DELAY, self._store)

    def restore(self, restore_reply: "Callable[[str], ResultResponder | None]") -> None:
        """Let the requests to the guard before wait here."""
        inherited = self._handover.inherited(self._key)
        for id, tokens in inherited.items() if isinstance(inherited, dict) else ():
            task = self._tasks.get(bytes.fromhex(id))
            for token in tokens[:MAX_PENDING_RESULTS] if task else ():
                answer = restore_reply(token)
                if task and answer:
                    task.add_result_request(answer)

    def store_soon(self) -> None:
        """Leave to the next guard who waits, once for many requests."""
        self._delayed_store.schedule()

    def _store(self) -> None:
        waiting = [task for task in self._tasks.values() if task.result_replies][:_MAX_STORED]
        tokens = {
            task.goal.id.hex(): [each.token for each in task.result_replies] for task in waiting
        }
        self._handover.store(self._key, tokens)
