"""The goals of an action that are not over: whose turn it is, and how they are handed over."""

from collections.abc import Callable

from rtron.guard.core.pipeline import Pipeline
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.core.timers import DelayedCall
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.goals.registry import MAX_GOALS, Goal, GoalRegistry, GoalStage
from rtron.vocabulary import SECOND, SERVER_FLOW, Stream


class GoalQueue:
    """Lets the pipeline's goals go one by one, and only while the server can take them.

    A stream of goals without an id shares the turns: it learns when a goal starts, when the turn is
    free, and which goals of the server's own begin and end, by their id.
    """

    def __init__(
        self,
        pipeline: Pipeline,
        transport: Transport,
        finish: Callable[[], None],
        may_send: Callable[[], bool],
    ) -> None:
        """`finish` lets the next goal go; while `may_send` says no, the turn stays taken."""
        self.on_goal_start: list[Callable[[], None]] = []
        self.on_turn_free: list[Callable[[], None]] = []
        self.on_server_goal: list[Callable[[bytes], None]] = []
        self.on_server_goal_end: list[Callable[[bytes], None]] = []
        self._pipeline = pipeline
        self._transport = transport
        self._finish = finish
        self._may_send = may_send
        self._current: Goal | None = None
        self._is_server_absent = self._expects_server_goal = False

    def start(self, goal: Goal) -> None:
        """Know that a client's goal goes to the server."""
        self._current = goal
        for notify in self.on_goal_start:
            notify()

    def restore(self, goal: Goal) -> None:
        """Go on with a goal that the guard before has sent."""
        self._current = goal
        self._pipeline.occupy(goal.flow, self._transport.now())

    def start_server_goal(self, goal: Goal, now: int) -> None:
        """Let others wait for a goal that did not come through here."""
        self._current, self._expects_server_goal = goal, False
        self._pipeline.occupy(SERVER_FLOW, now)
        for notify in self.on_server_goal:
            notify(goal.id)

    def end_server_goal(self, goal: Goal) -> None:
        """Tell that a goal is over which did not come through here."""
        for notify in self.on_server_goal_end:
            notify(goal.id)

    def end_turn(self, goal: Goal) -> None:
        """Let the next goal go if this was the one in progress."""
        if goal is self._current:
            self._current = None
            self._free()

    def expect_server_goal(self) -> None:
        """Let goals wait for one that the server is about to give itself."""
        self._expects_server_goal = True
        self._pipeline.occupy(SERVER_FLOW, self._transport.now())

    def stop_expecting(self, on_done: Callable[[], None]) -> None:
        """Expect no goal of the server's own any more, unless there is another after `on_done`."""
        self._expects_server_goal = False
        on_done()
        is_taken = self._expects_server_goal or self._current is not None
        if not is_taken and not self._is_server_absent:
            self._free()

    def await_server(self, now: int) -> None:
        """Let goals wait for a server that is gone."""
        self._is_server_absent, self._current, self._expects_server_goal = True, None, False
        self._pipeline.occupy(SERVER_FLOW, now)

    def resume(self) -> None:
        """Let goals go again that waited for a server which is back, if it has none of its own."""
        if self._is_server_absent:
            self._is_server_absent = False
            if self._current is None:
                self._free()

    def _free(self) -> None:
        """Let the next goal go: one that the server gives itself, if one waits, then our own."""
        if not self._may_send():
            self._is_server_absent = True
            return
        for notify in self.on_turn_free:
            notify()
        if not self._expects_server_goal:
            self._finish()


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
