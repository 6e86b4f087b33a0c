"""Whose turn it is at an action's server: a client's goal, or one that the server gives itself."""

from collections.abc import Callable

from rtron.guard.core.pipeline import Pipeline
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.goals.registry import Goal
from rtron.vocabulary import SERVER_FLOW


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
