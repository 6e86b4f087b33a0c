"""The status array that clients get: what the server lists, what waits here, what ended here."""

from collections import OrderedDict, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from rtron.guard.action.ros2.endpoints import MAX_PENDING_RESULTS, GoalReply, ResultReply
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros2.actions import ACCEPTED, GoalStatus, status_array
from rtron.policies.goals.registry import Goal
from rtron.vocabulary import SECOND


@dataclass(slots=True, eq=False)
class GoalTask:
    """A goal, and who waits for what.

    `asked` is the client that does not know yet whether its goal is accepted. `is_accepted` tells
    whether the server has it, `is_cancelled` that its client has given it up, `must_cancel` that the
    server is to cancel it as soon as it has it, `is_over` that it says that the goal has ended.
    """

    goal: Goal
    goal_reply: GoalReply | None = None
    is_accepted: bool = False
    is_cancelled: bool = False
    must_cancel: bool = False
    is_over: bool = False
    result_replies: list[ResultReply] = field(default_factory=list)

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

    def add_result_request(self, reply: ResultReply) -> bool:
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


RESULT_TIMEOUT = 10 * SECOND
"""As long as rcl_action's servers keep them."""
MAX_RESULTS = 256


@dataclass(frozen=True, slots=True)
class GoalResult:
    """How a goal of a client has ended; no result is an empty one."""

    client: str
    flow: str
    stamp: int
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


_MAX_ENDED = 1024
_PUBLISH_DELAY = SECOND // 50

PublishStatus = Callable[[bytes], None]


class StatusPublisher:
    """Tells the clients, soon after something has changed; once for many changes."""

    def __init__(
        self, tasks: Callable[[], Iterable[GoalTask]], transport: Transport, publish: PublishStatus
    ) -> None:
        self.server_statuses: dict[bytes, GoalStatus] = {}
        """What the server has told last."""
        self._tasks = tasks
        self._transport = transport
        self._publish = publish
        self._ended_goals: deque[tuple[int, GoalStatus]] = deque(maxlen=_MAX_ENDED)
        self._publish_scheduled = False

    def add_ended(self, task: GoalTask, status: int) -> None:
        """List a goal that ended here, whatever the server says of it."""
        goal_status = GoalStatus(task.goal.id, task.goal.stamp, status)
        self._ended_goals.append((self._transport.now() + RESULT_TIMEOUT, goal_status))
        self.publish_soon()

    def publish_soon(self) -> None:
        """Tell the clients what has changed here."""
        if not self._publish_scheduled:
            self._publish_scheduled = True
            self._transport.call_at(self._transport.now() + _PUBLISH_DELAY, self.publish)

    def publish(self) -> None:
        """Tell the clients of every goal."""
        self._publish_scheduled = False
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
