"""The status array that clients get: what the server lists, what waits here, what ended here."""

from collections import deque
from collections.abc import Callable, Iterable

from rtron.guard.action.ros2.results import RESULT_TIMEOUT
from rtron.guard.action.ros2.task import GoalTask
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros2.actions import ACCEPTED, GoalStatus, status_array
from rtron.vocabulary import SECOND

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
