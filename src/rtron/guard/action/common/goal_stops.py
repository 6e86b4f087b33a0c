"""Goals that may not go on are cancelled; their server moves nothing until they are over."""

import logging
from collections.abc import Callable
from typing import Protocol

from rtron.guard.action.common.action_goals import ActionGoals
from rtron.guard.core.pipeline import Pipeline
from rtron.policies.goals.registry import Goal, GoalStage

log = logging.getLogger(__name__)

StopHandler = Callable[[str, str], None]
"""Takes a server and why it may move nothing; "" once its stopped goals are over."""


class CancellingServer(Protocol):
    """The server of an action, as far as goals are stopped."""

    @property
    def node(self) -> str:
        """The node that serves the action, or has last served it; "" if none has."""
        ...

    def cancel(self, id: bytes) -> None:
        """Ask the server to cancel a goal."""
        ...


class GoalStops:
    """Cancels a goal as soon as a rule, a limit or a brake refuses it."""

    def __init__(self, goals: ActionGoals, pipeline: Pipeline, server: CancellingServer) -> None:
        self.on_goal_stopped: StopHandler = lambda node, why: None
        self._goals = goals
        self._pipeline = pipeline
        self._server = server
        self._reason = ""

    def recheck(self, now: int, brake_reason: str) -> None:
        """Stop the goals at the server that may not go on."""
        for goal in self._goals.registry:
            if goal.stage is GoalStage.SENT and not goal.cancel_reason:
                self._stop(goal, self._stop_reason(goal, now, brake_reason))
        self.update()

    def stop_server_goal(self, id: bytes, why: str) -> None:
        """Stop a goal that the server has given itself."""
        goal = self._goals.registry.find(id)
        if goal:
            self._stop(goal, why)
            self.update()

    def update(self) -> None:
        """Tell whether the server has a goal that was stopped, if that has changed."""
        goals = self._goals.registry
        reason = next((goal.cancel_reason for goal in goals if goal.cancel_reason), "")
        if reason != self._reason:
            self._reason = reason
            self.on_goal_stopped(self._server.node, reason)

    def repeat(self, node: str) -> None:
        """Tell it again of the node that serves the action now."""
        if self._reason:
            self.on_goal_stopped(node, self._reason)

    def _stop_reason(self, goal: Goal, now: int, brake_reason: str) -> str:
        """Return why a goal may not go on; one of the server's own unless all is stopped."""
        if goal.flow not in self._pipeline.tallies:
            return brake_reason
        return self._pipeline.refusal(goal.flow, now, goal.message or None)

    def _stop(self, goal: Goal, why: str) -> None:
        goal.cancel_reason = why
        if why:
            label = self._goals.label(goal)
            log.warning("%s: %s is cancelled: %s", self._goals.name, label, why)
            self._server.cancel(goal.id)
