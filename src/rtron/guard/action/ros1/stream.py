"""A guarded action: its goals go through a pipeline, and its other topics move with them.

To the clients the guard is the server, to the server it is the client (design section 5). A goal
that waits here is told as pending; each goal is answered once, by the server or by the guard.
"""

from functools import partial

from rtron.guard.action.common.stream import ORPHAN_TIMEOUT
from rtron.guard.action.ros1.server_tracker import ServerTracker
from rtron.guard.transport.common.protocol import MessageHandler, Peer
from rtron.messages.ros1.actions import (
    RECALLED,
    REJECTED,
    GoalID,
    read_cancel,
    read_goal,
    with_goal_id,
)
from rtron.policies.goals.registry import Goal, GoalStage
from rtron.vocabulary import (
    SECOND,
    UNAPPROVED,
    Decision,
    Ros1ActionTopic,
    Verdict,
    ros1_topic_name,
)


class Ros1ActionStream(ServerTracker):
    """A guarded stream of goals, with the cancels, statuses, feedback and results beside it."""

    _generated_ids = 0

    def open(self) -> None:
        """Join the graph; the goals that waited with the guard before went with it."""
        super().open()
        self._topics.open()
        self._inherit_goals()
        self._transport.call_at(self._transport.now() + ORPHAN_TIMEOUT, self._reply_to_orphans)
        self.recheck(self._transport.now())

    def cancel_receiver(self, flow: str, peer: Peer) -> MessageHandler | None:
        """Return what takes the cancels of a client."""
        if flow == UNAPPROVED and self.spec.block_unapproved and not self.dry_run:
            why = "not approved, its cancels are dropped"
            return lambda _message: self._log_problem(peer, why)
        return self._decoding_receiver(peer, partial(self._on_cancel, peer))

    def _is_latched_state(self, peer: Peer) -> bool:  # noqa: ARG002
        """Keep no goal for late subscribers: what a server missed it must not do later."""
        return False

    def _subscribe_done(self) -> None:
        """Know that a goal is done from its own result, whatever else the plan names."""
        if self.spec.done != ros1_topic_name(self.name, Ros1ActionTopic.RESULT):
            super()._subscribe_done()

    def _reply_to_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended, once their clients are back."""
        for goal in self.goals:
            if goal.stage is GoalStage.WAITING and not goal.message:
                self._reply(goal, RECALLED, "the guard was restarted")

    def _receiver_for(self, flow: str, peer: Peer) -> MessageHandler:
        if flow == UNAPPROVED and self.spec.block_unapproved:
            return super()._receiver_for(flow, peer)
        if self._is_planned_server(peer):
            return self._decoding_receiver(peer, self._on_server_goal_message)
        take = self._decoding_receiver(peer, partial(self._on_goal, flow, peer))
        return (
            self._latch_filter.filter(peer.node, take) if self._needs_latch_filter(peer) else take
        )

    def _on_goal(self, flow: str, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        goal_id = read_goal(message)
        if not goal_id.id:
            goal_id = GoalID(self._generate_id(now), goal_id.stamp)
            message = with_goal_id(message, goal_id)
        if why := self.goals.rejection_reason(goal_id.id, peer.node, now):
            self._log_problem(peer, why)
            return
        goal = Goal(goal_id.id, goal_id.stamp, flow, peer.node, message, last_seen=now)
        self.goals.add(goal)
        self._decide_goal(goal, now)
        self._goal_handover.store_soon()

    def _decide_goal(self, goal: Goal, now: int) -> None:
        if self.goals.was_cancelled_early(goal, now):
            self._reply(goal, RECALLED, "cancelled by its client")
        elif why := self._refusal_reason(goal):
            self._reply(goal, REJECTED, why)
        else:
            verdict = self._receive(goal.flow, goal.message)
            if verdict is None or verdict.decision is Decision.DROP:
                self._reply(goal, REJECTED, verdict.reason if verdict else "internal error")
            elif verdict.decision is Decision.HOLD:
                self._replies.publish_soon()

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        goal_id = read_goal(message)
        super()._on_passed(flow, self._with_ordered_stamp(goal_id, message), now)
        goal = self.goals.find(goal_id.id)
        if goal:
            self.goals.mark_sent(goal, now)
            self._current_goal = goal
            for notify in self.on_goal_start:
                notify()
            self._goal_handover.store_soon()

    def _on_dropped_goal(self, message: bytes, verdict: Verdict) -> None:
        goal = self.goals.find(read_goal(message).id)
        if goal and goal.stage is GoalStage.WAITING:
            self._reply(goal, RECALLED, verdict.reason)

    def _with_ordered_stamp(self, goal_id: GoalID, message: bytes) -> bytes:
        stamp = self.goals.monotonic_stamp(goal_id.stamp)
        return (
            message if stamp == goal_id.stamp else with_goal_id(message, GoalID(goal_id.id, stamp))
        )

    def _on_cancel(self, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        if self.dry_run:
            self._topics.publish_cancel(message)
        goal_id = read_cancel(message)
        for goal in self.goals.cancel_targets(peer.node, goal_id.id, goal_id.stamp, now):
            if goal.stage is GoalStage.WAITING:
                self.pipeline.withdraw(goal.message, "cancelled by its client", now)
            else:
                self._cancel_at_server(goal.id)

    def _generate_id(self, now: int) -> bytes:
        self._generated_ids += 1
        return f"{self.nodes[0]}-{self._generated_ids}-{now // SECOND}.{now % SECOND:09}".encode()
