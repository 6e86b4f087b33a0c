"""What the guard tells the clients of an action: how goals end, and which wait."""

import logging
import time
from collections import deque
from collections.abc import Iterator

from rtron.guard.action.common.action_goals import ORPHAN_TIMEOUT, ActionGoals
from rtron.guard.action.ros1.server_state import ServerState
from rtron.guard.action.ros1.topics import ActionTopics
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.core.timers import DelayedCall
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros1.actions import GoalID, GoalStatus, result_message, with_statuses
from rtron.policies.goals.registry import ID_REUSE_DELAY, Goal
from rtron.vocabulary import SECOND, Ros1ActionTopic

log = logging.getLogger(__name__)

_MAX_ENDED = 1024
_PUBLISH_DELAY = SECOND // 50
_LOOK_PERIOD = SECOND // 50
_MAX_WAITING = 64
"""How many results wait for their clients at most; the oldest goes first."""


class ClientReplies:
    """Answers in the server's place, and adds to its statuses the goals that it does not list.

    What the guard has answered stays listed for as long as actionlib's server lists what is over:
    a client that misses its goal there takes it for lost. Without a server nothing is published.
    """

    def __init__(
        self, topics: ActionTopics, server: ServerState, goals: ActionGoals, context: StreamContext
    ) -> None:
        self._topics = topics
        self._results = _ResultOutbox(topics, context.transport)
        self._server = server
        self._goals = goals
        self._transport = context.transport
        self._dry_run = context.dry_run
        self._ended_goals: deque[tuple[int, GoalStatus]] = deque(maxlen=_MAX_ENDED)
        self._delayed_status = DelayedCall(self._transport, _PUBLISH_DELAY, self.publish_status)

    def finish(self, goal: Goal, status: int, reason: str) -> None:
        """End a goal in the server's place, and answer its client."""
        self._goals.end(goal, self._transport.now())
        if goal.client and not self._dry_run:
            log.info("%s: %s: %s", self._goals.name, self._goals.label(goal), reason)
            self._send_result(goal, GoalStatus(GoalID(goal.id, goal.stamp), status, reason))

    def forward(self, client: str, result: bytes) -> None:
        """Hand on a result of the server."""
        self._results.send(client, result)

    def list_ended(self, status: GoalStatus) -> None:
        """List a goal that is over for a while: a client may get a status before its result."""
        self._ended_goals.append((self._transport.now() + ID_REUSE_DELAY, status))

    def publish_soon(self) -> None:
        """Tell the clients what has changed here; once for many changes."""
        self._delayed_status.schedule()

    def publish_status(self) -> None:
        """Tell the clients what the server has told, and what waits here."""
        if self._server.last_status and self._server.is_visible:
            message = with_statuses(self._server.last_status, list(self._unlisted_goals()))
            self._topics.publish(Ros1ActionTopic.STATUS, message)

    def _send_result(self, goal: Goal, status: GoalStatus) -> None:
        self.list_ended(status)
        if self._server.empty_result is not None:
            message = result_message(time.time_ns(), status, self._server.empty_result)
            self._results.send(goal.client, message)
        self.publish_soon()

    def _unlisted_goals(self) -> Iterator[GoalStatus]:
        """Yield the state of goals that the server does not list."""
        now, listed_ids = self._transport.now(), self._server.listed_goals
        for goal in self._goals.registry:
            if goal.id not in listed_ids and goal.client:
                yield GoalStatus(GoalID(goal.id, goal.stamp), goal.status)
        for until, status in self._ended_goals:
            if now < until and status.goal.id not in listed_ids:
                yield status


class _ResultOutbox:
    """Sends each result when the client of its goal hears this guard, or after a while anyhow.

    After a restart clients come back one by one, and a server may have a result before that.
    """

    def __init__(self, topics: ActionTopics, transport: Transport) -> None:
        self._topics = topics
        self._transport = transport
        self._waiting: deque[tuple[int, str, bytes]] = deque()
        self._look = DelayedCall(transport, _LOOK_PERIOD, self._send_waiting)

    def send(self, client: str, result: bytes) -> None:
        """Send the result of a goal of `client`, "" if nobody here has sent that goal."""
        if not client or self._topics.reaches_client(client):
            self._topics.publish(Ros1ActionTopic.RESULT, result)
            return
        if len(self._waiting) == _MAX_WAITING:
            self._topics.publish(Ros1ActionTopic.RESULT, self._waiting.popleft()[2])
        self._waiting.append((self._transport.now() + ORPHAN_TIMEOUT, client, result))
        self._look.schedule()

    def _send_waiting(self) -> None:
        now = self._transport.now()
        waiting, self._waiting = self._waiting, deque()
        for until, client, result in waiting:
            if now >= until or self._topics.reaches_client(client):
                self._topics.publish(Ros1ActionTopic.RESULT, result)
            else:
                self._waiting.append((until, client, result))
        if self._waiting:
            self._look.schedule()
