"""What the clients of an action are told by the guard: the ends of goals, and what waits."""

import logging
import time
from collections import deque
from collections.abc import Callable, Iterator

from rtron.guard.action.ros1.server_state import Server
from rtron.guard.action.ros1.topics import ActionEnds
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.ros1.actions import GoalID, GoalStatus, result_message, with_statuses
from rtron.policies.goals.registry import AGAIN_AFTER, Goal, Goals
from rtron.vocabulary import SECOND, ActionPart

log = logging.getLogger(__name__)

_MOST_TOLD = 1024
_TELL_AFTER = SECOND // 50


class Desk:
    """Answers in the server's place, and adds to its statuses the goals that it does not list.

    What the guard has answered stays listed for as long as actionlib's server lists what is over:
    a client that misses its goal there takes it for lost. `serves` tells whether the server is
    there, since nothing is told in its absence.
    """

    def __init__(
        self,
        parts: ActionEnds,
        server: Server,
        goals: Goals,
        transport: Transport,
        serves: Callable[[], bool],
    ) -> None:
        self._parts = parts
        self._server = server
        self._goals = goals
        self._transport = transport
        self._serves = serves
        self._answered: deque[tuple[int, GoalStatus]] = deque(maxlen=_MOST_TOLD)
        self._telling = False

    def answer(self, goal: Goal, status: int, why: str) -> None:
        """Tell a client how its goal has ended."""
        told = GoalStatus(GoalID(goal.id, goal.stamp), status, why)
        self.keep_listed(told)
        if self._server.empty_result is not None:
            message = result_message(time.time_ns(), told, self._server.empty_result)
            self._parts.answer(ActionPart.RESULT, message)
        self.tell_soon()

    def keep_listed(self, told: GoalStatus) -> None:
        """List a goal that is over for a while: a client may get a status before its result."""
        self._answered.append((self._transport.now() + AGAIN_AFTER, told))

    def tell_soon(self) -> None:
        """Tell the clients what has changed here; once for many changes."""
        if not self._telling:
            self._telling = True
            self._transport.call_at(self._transport.now() + _TELL_AFTER, self.tell)

    def tell(self) -> None:
        """Tell the clients what the server has told, and what waits here."""
        self._telling = False
        if self._server.told and self._serves():
            message = with_statuses(self._server.told, list(self._unlisted()))
            self._parts.answer(ActionPart.STATUS, message)

    def _unlisted(self) -> Iterator[GoalStatus]:
        """Yield the state of goals that the server does not list."""
        now, listed = self._transport.now(), self._server.listed
        for goal in self._goals:
            if goal.id not in listed and goal.client:
                yield GoalStatus(GoalID(goal.id, goal.stamp), goal.status)
        for until, told in self._answered:
            if now < until and told.goal.id not in listed:
                yield told
