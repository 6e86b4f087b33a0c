"""What the clients of an action are told by the guard: the ends of goals, and what waits."""

import logging
import time
from collections import deque
from collections.abc import Callable, Iterator

from rtron.guard.action.ros1.server_state import ServerState
from rtron.guard.action.ros1.topics import ActionTopics
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros1.actions import GoalID, GoalStatus, result_message, with_statuses
from rtron.policies.goals.registry import ID_REUSE_DELAY, Goal, GoalRegistry
from rtron.vocabulary import SECOND, Ros1ActionTopic

log = logging.getLogger(__name__)

_MAX_ENDED = 1024
_PUBLISH_DELAY = SECOND // 50


class ClientReplies:
    """Answers in the server's place, and adds to its statuses the goals that it does not list.

    What the guard has answered stays listed for as long as actionlib's server lists what is over:
    a client that misses its goal there takes it for lost. `is_server_visible` tells whether the server is
    there, since nothing is told in its absence.
    """

    def __init__(
        self,
        topics: ActionTopics,
        server: ServerState,
        goals: GoalRegistry,
        transport: Transport,
        is_server_visible: Callable[[], bool],
    ) -> None:
        self._topics = topics
        self._server = server
        self._goals = goals
        self._transport = transport
        self._is_server_visible = is_server_visible
        self._ended_goals: deque[tuple[int, GoalStatus]] = deque(maxlen=_MAX_ENDED)
        self._publish_scheduled = False

    def reply(self, goal: Goal, status: int, reason: str) -> None:
        """Tell a client how its goal has ended."""
        status_message = GoalStatus(GoalID(goal.id, goal.stamp), status, reason)
        self.list_ended(status_message)
        if self._server.empty_result is not None:
            message = result_message(time.time_ns(), status_message, self._server.empty_result)
            self._topics.publish(Ros1ActionTopic.RESULT, message)
        self.publish_soon()

    def list_ended(self, status: GoalStatus) -> None:
        """List a goal that is over for a while: a client may get a status before its result."""
        self._ended_goals.append((self._transport.now() + ID_REUSE_DELAY, status))

    def publish_soon(self) -> None:
        """Tell the clients what has changed here; once for many changes."""
        if not self._publish_scheduled:
            self._publish_scheduled = True
            self._transport.call_at(self._transport.now() + _PUBLISH_DELAY, self.publish_status)

    def publish_status(self) -> None:
        """Tell the clients what the server has told, and what waits here."""
        self._publish_scheduled = False
        if self._server.last_status and self._is_server_visible():
            message = with_statuses(self._server.last_status, list(self._unlisted_goals()))
            self._topics.publish(Ros1ActionTopic.STATUS, message)

    def _unlisted_goals(self) -> Iterator[GoalStatus]:
        """Yield the state of goals that the server does not list."""
        now, listed_ids = self._transport.now(), self._server.listed_goals
        for goal in self._goals:
            if goal.id not in listed_ids and goal.client:
                yield GoalStatus(GoalID(goal.id, goal.stamp), goal.status)
        for until, status in self._ended_goals:
            if now < until and status.goal.id not in listed_ids:
                yield status
