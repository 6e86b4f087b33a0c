"""The status array that clients get: what the server lists, what waits here, what ended here."""

from collections import deque
from collections.abc import Callable, Iterable

from rtron.guard.action.ros2.results import KEPT_FOR
from rtron.guard.action.ros2.task import Task
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros2.actions import ACCEPTED, GoalStatus, status_array
from rtron.vocabulary import SECOND

_MOST_ENDED = 1024
_TELL_AFTER = SECOND // 50

Tell = Callable[[bytes], None]


class Desk:
    """Tells the clients, soon after something has changed; once for many changes."""

    def __init__(
        self, tasks: Callable[[], Iterable[Task]], transport: Transport, tell: Tell
    ) -> None:
        self.listed: dict[bytes, GoalStatus] = {}
        """What the server has told last."""
        self._tasks = tasks
        self._transport = transport
        self._tell = tell
        self._ended: deque[tuple[int, GoalStatus]] = deque(maxlen=_MOST_ENDED)
        self._telling = False

    def ended(self, task: Task, status: int) -> None:
        """List a goal that ended here, whatever the server says of it."""
        told = GoalStatus(task.goal.id, task.goal.stamp, status)
        self._ended.append((self._transport.now() + KEPT_FOR, told))
        self.tell_soon()

    def tell_soon(self) -> None:
        """Tell the clients what has changed here."""
        if not self._telling:
            self._telling = True
            self._transport.call_at(self._transport.now() + _TELL_AFTER, self.tell)

    def tell(self) -> None:
        """Tell the clients of every goal."""
        self._telling = False
        now = self._transport.now()
        while self._ended and self._ended[0][0] <= now:
            self._ended.popleft()
        listed = dict(self.listed)
        for task in self._tasks():
            goal = task.goal
            if goal.client and task.known and goal.id not in listed:
                listed[goal.id] = GoalStatus(goal.id, goal.stamp, ACCEPTED)
        listed |= {told.id: told for _, told in self._ended}
        self._tell(status_array(listed.values()))
