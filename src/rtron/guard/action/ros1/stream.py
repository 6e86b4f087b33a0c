"""A guarded action: its goals go through a pipeline, and its other topics move with them.

To the clients the guard is the server, to the server it is the client (design section 5). A goal
that waits here is told as pending; each goal is answered once, by the server or by the guard.
"""

from functools import partial

from rtron.guard.action.common.stream import ORPHANED
from rtron.guard.action.ros1.server_tracker import ServedAction
from rtron.guard.transport.common.protocol import Peer, Receive
from rtron.messages.ros1.actions import (
    RECALLED,
    REJECTED,
    GoalID,
    read_cancel,
    read_goal,
    with_goal_id,
)
from rtron.policies.goals.registry import Goal, Where
from rtron.vocabulary import (
    SECOND,
    UNAPPROVED,
    ActionPart,
    Decision,
    Verdict,
    part_topic,
)


class GuardedAction(ServedAction):
    """A guarded stream of goals, with the cancels, statuses, feedback and results beside it."""

    _named = 0

    def open(self) -> None:
        """Join the graph; the goals that waited with the guard before went with it."""
        super().open()
        self._parts.open()
        self._inherited()
        self._transport.call_at(self._transport.now() + ORPHANED, self._answer_orphans)
        self.attend(self._transport.now())

    def cancels_of(self, flow: str, peer: Peer) -> Receive | None:
        """Return what takes the cancels of a client."""
        if flow == UNAPPROVED and self.stream.block_unapproved and not self.dry_run:
            why = "not approved, its cancels are dropped"
            return lambda _message: self._complain(peer, why)
        return self._reading(peer, partial(self._cancel, peer))

    def _keeps(self, peer: Peer) -> bool:  # noqa: ARG002
        """Keep no goal for late subscribers: what a server missed it must not do later."""
        return False

    def _open_done(self) -> None:
        """Know that a goal is done from its own result, whatever else the plan names."""
        if self.stream.done != part_topic(self.name, ActionPart.RESULT):
            super()._open_done()

    def _answer_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended, once their clients are back."""
        for goal in self.goals:
            if goal.where is Where.WAITING and not goal.message:
                self._answer(goal, RECALLED, "the guard was restarted")

    def _taking(self, flow: str, peer: Peer) -> Receive:
        if flow == UNAPPROVED and self.stream.block_unapproved:
            return super()._taking(flow, peer)
        if self._is_server(peer):
            return self._reading(peer, self._own_goal)
        take = self._reading(peer, partial(self._goal, flow, peer))
        return self._latched.once(peer.node, take) if self._goes_once(peer) else take

    def _goal(self, flow: str, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        asked = read_goal(message)
        if not asked.id:
            asked = GoalID(self._name_goal(now), asked.stamp)
            message = with_goal_id(message, asked)
        if why := self.goals.why_not(asked.id, peer.node, now):
            self._complain(peer, why)
            return
        goal = Goal(asked.id, asked.stamp, flow, peer.node, message, seen=now)
        self.goals.add(goal)
        self._decide(goal, now)
        self._bequest.keep()

    def _decide(self, goal: Goal, now: int) -> None:
        if self.goals.came_cancelled(goal, now):
            self._answer(goal, RECALLED, "cancelled by its client")
        elif why := self._why_refused(goal):
            self._answer(goal, REJECTED, why)
        else:
            verdict = self._receive(goal.flow, goal.message)
            if verdict is None or verdict.decision is Decision.DROP:
                self._answer(goal, REJECTED, verdict.reason if verdict else "internal error")
            elif verdict.decision is Decision.HOLD:
                self._desk.tell_soon()

    def _passed(self, flow: str, message: bytes, now: int) -> None:
        asked = read_goal(message)
        super()._passed(flow, self._in_order(asked, message), now)
        goal = self.goals.find(asked.id)
        if goal:
            self.goals.send(goal, now)
            self._current = goal
            for began in self.began:
                began()
            self._bequest.keep()

    def _gave_up(self, message: bytes, verdict: Verdict) -> None:
        goal = self.goals.find(read_goal(message).id)
        if goal and goal.where is Where.WAITING:
            self._answer(goal, RECALLED, verdict.reason)

    def _in_order(self, asked: GoalID, message: bytes) -> bytes:
        stamp = self.goals.in_order(asked.stamp)
        return message if stamp == asked.stamp else with_goal_id(message, GoalID(asked.id, stamp))

    def _cancel(self, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        if self.dry_run:
            self._parts.cancel(message)
        asked = read_cancel(message)
        for goal in self.goals.cancelled(peer.node, asked.id, asked.stamp, now):
            if goal.where is Where.WAITING:
                self.pipeline.withdraw(goal.message, "cancelled by its client", now)
            else:
                self._cancel_at_server(goal.id)

    def _name_goal(self, now: int) -> bytes:
        self._named += 1
        return f"{self.nodes[0]}-{self._named}-{now // SECOND}.{now % SECOND:09}".encode()
