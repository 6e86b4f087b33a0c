"""What the guard of an action does in either ROS: goals come and go, and are stopped if need be."""

import logging
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

from rtron.guard.action.common.turns import TurnSharingStream
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.observations import Observations
from rtron.guard.transport.common.protocol import Peer, Transport
from rtron.policies.goals.registry import MAX_GOALS, Goal, GoalRegistry, GoalStage
from rtron.vocabulary import SECOND, SERVER_FLOW, Stream, Verdict


def with_queue_space(stream: Stream) -> Stream:
    """Let the queue have room for every flow's share, which is bounded before it."""
    first, *others = stream.stages
    size = stream.queue_size * (len(stream.flows) + 1)
    first = replace(first, settings=replace(first.settings, queue_size=size))
    return replace(stream, stages=(first, *others))


_STORE_DELAY = SECOND // 100


class GoalHandover:
    """Keeps the goals of an action in the will, soon after they changed: many may do so at once."""

    def __init__(
        self, name: str, goals: GoalRegistry, handover: HandoverState, transport: Transport
    ) -> None:
        self._name = name
        self._goals = goals
        self._handover = handover
        self._transport = transport
        self._store_scheduled = False

    def restore(self) -> bool:
        """Know the goals that the guard before has left; tell whether there was one."""
        inherited = self._handover.inherited(self._name)
        if inherited:
            self._goals.restore(inherited, self._transport.now())
        return bool(inherited)

    def store_soon(self) -> None:
        """Leave to the next guard whose goals there are."""
        if not self._store_scheduled:
            self._store_scheduled = True
            self._transport.call_at(self._transport.now() + _STORE_DELAY, self.store)

    def store(self) -> None:
        """Leave it before anything else happens: a goal that is answered must not be again."""
        self._store_scheduled = False
        self._handover.store(self._name, self._goals.snapshot())


log = logging.getLogger(__name__)

ORPHAN_TIMEOUT = 3 * SECOND
"""So long the clients of a guard that has ended may take to come to the next one."""
MAX_NAME_LENGTH = 128
_MAX_NAMES = 64


class ActionStream(TurnSharingStream):
    """A guarded stream of goals; how they are spoken of is each ROS's own."""

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        observations: Observations,
        handover: HandoverState,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, observations, handover, dry_run=dry_run)
        self.pipeline.on_dropped = self._on_dropped_goal
        self._goal_handover = GoalHandover(self.name, self.goals, handover, transport)
        self._most_waiting = stream.queue_size
        self._log_throttle = LogThrottle()

    def recheck(self, now: int) -> None:
        """Cancel what may not go on, and stop what it moves."""
        super().recheck(now)
        for goal in () if self.dry_run else self.goals:
            if goal.stage is GoalStage.SENT and not goal.cancel_reason:
                self._stop_goal(goal, self._stop_reason(goal, now))
        self._halt()

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        waiting = sum(goal.stage is GoalStage.WAITING for goal in self.goals)
        return {
            "goals": f"{waiting} waiting, {len(self.goals) - waiting} with the server",
            "server": self._server_node() if self._is_server_visible() else "not there",
        }

    # What each ROS does its own way

    @abstractmethod
    def _is_server_ready(self) -> bool:
        """Tell whether the server is there, and hears us."""

    @abstractmethod
    def _is_server_visible(self) -> bool:
        """Tell whether clients may know that the server is there: they will get their answers."""

    @abstractmethod
    def _cancel_at_server(self, id: bytes) -> None:
        """Ask the server to cancel a goal."""

    @abstractmethod
    def _on_dropped_goal(self, message: bytes, verdict: Verdict) -> None:
        """Answer a goal that was held and will not go."""

    @abstractmethod
    def _goal_label(self, goal: Goal) -> str:
        """Return what to call a goal."""

    # Goals that come and go

    def _with_defaults(self, stream: Stream) -> Stream:
        """Let the queue have room for every flow's share, which is bounded before it."""
        return with_queue_space(super()._with_defaults(stream))

    def _inherit_goals(self) -> Sequence[Goal]:
        """Go on with the goals of the guard before, and return them all."""
        inherited = list(self.goals) if self._goal_handover.restore() else []
        for goal in inherited:
            if goal.stage is GoalStage.SENT:
                self._current_goal = goal
                self.pipeline.occupy(goal.flow, self._transport.now())
        return inherited

    def _refusal_reason(self, goal: Goal) -> str:
        """Return why a goal cannot be taken, whatever the policies say."""
        if self.dry_run:
            return ""
        if not self._is_server_ready():
            return "the action server is not there"
        if len(self.goals) > MAX_GOALS:
            return f"{MAX_GOALS} goals are not over"
        full = self.goals.waiting_count(goal.flow) > self._most_waiting
        return f"{self._most_waiting} goals wait" if full else ""

    def _on_foreign_goal(self, goal: Goal, now: int) -> None:
        """Let others wait for a goal that did not come through here."""
        self._current_goal, self._expects_server_goal = goal, False
        self.pipeline.occupy(SERVER_FLOW, now)
        self._goal_handover.store_soon()
        for appeared in self.on_server_goal:
            appeared(goal.id)
        if self.brake_reason:
            self.recheck(now)

    def _end(self, goal: Goal, now: int) -> None:
        """Know that a goal is over."""
        self.goals.finish(goal, now)
        self._halt()
        for ended in () if goal.client else self.on_server_goal_end:
            ended(goal.id)
        self._goal_handover.store_soon()

    # What may not go on

    def _stop_reason(self, goal: Goal, now: int) -> str:
        """Return why a goal may not go on; one of the server's own unless all is stopped."""
        if goal.flow not in self.pipeline.tallies:
            return self.brake_reason
        return self.pipeline.refusal(goal.flow, now, goal.message or None)

    def _stop_goal(self, goal: Goal, why: str) -> None:
        goal.cancel_reason = why
        if why:
            log.warning("%s: %s is cancelled: %s", self.name, self._goal_label(goal), why)
            self._cancel_at_server(goal.id)

    # A server that goes and comes back

    def _await_server(self, now: int) -> None:
        """Let goals wait for a server that is gone."""
        self._is_server_absent, self._current_goal, self._expects_server_goal = True, None, False
        self.pipeline.occupy(SERVER_FLOW, now)

    def _resume_with_server(self) -> None:
        """Let goals go again that waited for a server which is back, if it has none of its own."""
        if self._is_server_absent and self._is_server_ready():
            self._is_server_absent = False
            if self._current_goal is None:
                self._free_turn()

    # What is told

    def _log_problem(self, peer: Peer, why: str) -> None:
        name = peer.node[:MAX_NAME_LENGTH]
        if self._may_log("complaint", name):
            log.warning("%s: %s: %s", self.name, name, why)

    def _may_log(self, kind: str, name: str) -> bool:
        """Tell whether to say something of a node: one that makes much of it hides no other."""
        return self._log_throttle.allows((kind, hash(name) % _MAX_NAMES), self._transport.now())
