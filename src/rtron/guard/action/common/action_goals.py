"""The goals of an action that are not over, in either ROS, and their handover to the next guard."""

from collections.abc import Callable

from rtron.guard.action.common.goal_queue import GoalQueue
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.core.timers import DelayedCall
from rtron.policies.goals.registry import MAX_GOALS, Goal, GoalRegistry, GoalStage
from rtron.vocabulary import SECOND, Stream

ORPHAN_TIMEOUT = 3 * SECOND
"""So long the clients of a guard that has ended may take to come to the next one."""
_STORE_DELAY = SECOND // 100


class ActionGoals:
    """Whose goals there are, which has the turn, and what the next guard must know of them."""

    def __init__(
        self, spec: Stream, queue: GoalQueue, context: StreamContext, label: Callable[[Goal], str]
    ) -> None:
        """`label` gives the name of a goal in the log."""
        self.name = spec.action
        self.registry = GoalRegistry()
        self.queue = queue
        self.label = label
        self.on_end: Callable[[], None] = lambda: None
        self.on_result: Callable[[bytes], None] = lambda goal_id: None
        """Takes the id of a goal whose result has come."""
        self._context = context
        self._most_waiting = spec.queue_size
        self._delayed_store = DelayedCall(context.transport, _STORE_DELAY, self.store)

    def restore(self) -> list[Goal]:
        """Go on with the goals of the guard before, and return them all."""
        inherited = self._context.handover.inherited(self.name)
        if not inherited:
            return []
        self.registry.restore(inherited, self._context.transport.now())
        for goal in self.registry:
            if goal.stage is GoalStage.SENT:
                self.queue.restore(goal)
        return list(self.registry)

    def store_soon(self) -> None:
        """Leave to the next guard whose goals there are, once for many changes."""
        self._delayed_store.schedule()

    def store(self) -> None:
        """Leave it before anything else happens: a goal that is answered must not be again."""
        self._context.handover.store(self.name, self.registry.snapshot())

    def refusal_reason(self, goal: Goal, *, is_server_ready: bool) -> str:
        """Return why a goal cannot be taken, whatever the policies say; "" if it can."""
        if self._context.dry_run:
            return ""
        if not is_server_ready:
            return "the action server is not there"
        if len(self.registry) > MAX_GOALS:
            return f"{MAX_GOALS} goals are not over"
        full = self.registry.waiting_count(goal.flow) > self._most_waiting
        return f"{self._most_waiting} goals wait" if full else ""

    def start_server_goal(self, goal: Goal, now: int) -> None:
        """Let others wait for a goal that did not come through here."""
        self.queue.start_server_goal(goal, now)
        self.store_soon()

    def end(self, goal: Goal, now: int) -> None:
        """Know that a goal is over."""
        self.registry.finish(goal, now)
        self.on_end()
        if not goal.client:
            self.queue.end_server_goal(goal)
        self.store_soon()

    def details(self, server: str) -> dict[str, str]:
        """Return what there is to report; `server` is the node that clients can see, or ""."""
        waiting = sum(goal.stage is GoalStage.WAITING for goal in self.registry)
        return {
            "goals": f"{waiting} waiting, {len(self.registry) - waiting} with the server",
            "server": server or "not there",
        }
