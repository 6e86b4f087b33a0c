"""Goals without an id, as on `goal_pose`: followed to the goal that the server makes of each."""

import logging
from functools import partial
from typing import Protocol

from rtron.guard.action.common.action_goals import GoalQueue
from rtron.guard.action.common.goal_stops import GoalStops
from rtron.guard.core.stream import GuardedStream
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.policies.goals.goal_tracker import GoalTracker
from rtron.vocabulary import SECOND, SERVER_FLOW, Stream

log = logging.getLogger(__name__)

_APPEARANCE_TIMEOUT = 5 * SECOND


class ActionObserver(Protocol):
    """Tells a `SimpleGoalStream` of the goals of its action, and cancels them."""

    @property
    def sees_goals(self) -> bool:
        """Whether a goal that the server makes of a message is seen."""
        ...

    def open(self, stream: "SimpleGoalStream") -> None:
        """Tell a stream from now on."""
        ...

    def expect_goal(self) -> None:
        """Know that the server is about to give itself a goal."""
        ...

    def stop_expecting(self, stream: "SimpleGoalStream") -> None:
        """Let a stream go on: no goal has appeared."""
        ...

    def cancel(self, goal: bytes, why: str) -> None:
        """Ask for the cancel of a goal."""
        ...


class GuardedActionObserver:
    """An action that has a guard, too: it knows of goals before anybody else."""

    sees_goals = True

    def __init__(self, queue: GoalQueue, stops: GoalStops) -> None:
        self._queue = queue
        self._stops = stops

    def open(self, stream: "SimpleGoalStream") -> None:
        """Share the turns of the action."""
        self._queue.on_goal_start.append(stream.occupy_turn)
        self._queue.on_server_goal.append(stream.on_server_goal)
        self._queue.on_server_goal_end.append(stream.on_goal_end)
        self._queue.on_turn_free.append(stream.on_turn_free)

    def expect_goal(self) -> None:
        """Let the action's own goals wait."""
        self._queue.expect_server_goal()

    def stop_expecting(self, stream: "SimpleGoalStream") -> None:
        """Give the turn to the next message, else to the action's own goals."""
        self._queue.stop_expecting(stream.on_action_done)

    def cancel(self, goal: bytes, why: str) -> None:
        """Cancel a goal, and stop what it moves."""
        self._stops.stop_server_goal(goal, why)


class SimpleGoalStream(GuardedStream):
    """A guarded stream whose messages become goals of an action.

    `action` is its name; `observer` serves while the action has no guard.
    """

    def __init__(
        self, stream: Stream, context: StreamContext, action: str, observer: ActionObserver
    ) -> None:
        super().__init__(stream, context)
        self.action = action
        self.goal_tracker = GoalTracker()
        self._observer = observer
        self._cancelled_goal: bytes | None = None
        self._sent_count = 0

    def attach(self, queue: GoalQueue, stops: GoalStops) -> None:
        """Learn of goals from the guard of the action, before this is opened."""
        self._observer = GuardedActionObserver(queue, stops)

    def recheck(self, now: int) -> None:
        """Cancel the goal in progress if what asked for it may not go on."""
        super().recheck(now)
        goal, flow = self.goal_tracker.goal, self.goal_tracker.flow
        if goal in (None, self._cancelled_goal) or self.dry_run:
            return
        if why := self.pipeline.refusal(flow, now):
            self._cancelled_goal = goal
            log.warning("%s: goal %r is cancelled: %s", self.spec.topic, goal[:128], why)
            self._observer.cancel(goal, why)

    def on_server_goal(self, id: bytes) -> None:
        """Take a goal that the server has given itself; nobody here may have asked for it."""
        self.goal_tracker.add_goal(id)
        if id != self.goal_tracker.goal:
            self.occupy_turn()

    def on_goal_end(self, id: bytes) -> None:
        """Let the next message go if the goal of the last one is over."""
        if self.goal_tracker.finish_goal(id):
            self.on_action_done()

    def on_turn_free(self) -> None:
        """Let goals go again that waited for one of the action."""
        if self.pipeline.owner == SERVER_FLOW:
            self.on_action_done()

    def occupy_turn(self) -> None:
        """Let goals wait for one of the action."""
        self.pipeline.occupy(SERVER_FLOW, self._transport.now())

    def _join_graph(self) -> None:
        self.endpoints.open()
        self._observer.open(self)

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        super()._on_passed(flow, message, now)
        self.goal_tracker.expect_goal(flow)
        self._sent_count += 1
        self._observer.expect_goal()
        check = partial(self._check_goal_appeared, self._sent_count)
        self._transport.call_at(now + _APPEARANCE_TIMEOUT, check)

    def _check_goal_appeared(self, sent_count: int) -> None:
        """Let others go if the server has made no goal of a message."""
        is_missing = sent_count == self._sent_count and self.goal_tracker.is_expecting
        if is_missing and self._observer.sees_goals:
            log.warning("%s: no goal has appeared", self.spec.topic)
            self.goal_tracker.stop_expecting()
            self._observer.stop_expecting(self)
