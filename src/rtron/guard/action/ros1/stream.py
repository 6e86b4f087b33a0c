"""A guarded action: its goals go through a pipeline, and its other topics move with them.

To the clients the guard is the server, to the server it is the client (design section 5). A goal
that waits here is told as pending; each goal is answered once, by the server or by the guard.
"""

from functools import partial

from rtron.guard.action.common.action_goals import ORPHAN_TIMEOUT, ActionGoals, GoalQueue
from rtron.guard.action.common.goal_stops import GoalStops
from rtron.guard.action.common.problem_log import ProblemLog
from rtron.guard.action.ros1.client_replies import ClientReplies
from rtron.guard.action.ros1.server_state import ServerState
from rtron.guard.action.ros1.server_tracker import ServerTracker
from rtron.guard.action.ros1.topics import ActionTopics
from rtron.guard.core.stream import GuardedStream
from rtron.guard.core.stream_endpoints import InputRules, StreamContext
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
    Stream,
    Verdict,
    ros1_topic_name,
)


class Ros1ActionStream(GuardedStream):
    """A guarded stream of goals, with the cancels, statuses, feedback and results beside it."""

    def __init__(self, stream: Stream, context: StreamContext) -> None:
        # No goal is latched for late subscribers: what a server missed it must not do later.
        super().__init__(stream, context, InputRules(self._goal_receiver, latches=False))
        self._problems = ProblemLog(stream.action, context.transport)
        queue = GoalQueue(self.pipeline, context.transport, self.on_action_done, lambda: True)
        self.goals = ActionGoals(self.spec, queue, context, _goal_label)
        self._topics = ActionTopics(self.spec, self.nodes[0], context.transport, self)
        state = ServerState(self._reaches)
        self._replies = ClientReplies(self._topics, state, self.goals, context)
        self.server = ServerTracker(
            state,
            self._topics,
            self.goals,
            self._replies,
            self._problems,
            context,
        )
        self.stops = GoalStops(self.goals, self.pipeline, self.server)
        self.goals.on_end, self.goals.on_result = self.stops.update, self._measure_goal_end
        queue.on_server_goal.append(self._on_server_goal)
        self.pipeline.on_dropped = self._on_dropped_goal
        self._generated_ids = 0

    @property
    def name(self) -> str:
        """The action's name."""
        return self.spec.action

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        return self.goals.details(self.server.node if self.server.state.is_visible else "")

    def open(self) -> None:
        """Join the graph; the goals that waited with the guard before went with it."""
        super().open()
        self._topics.open()
        self.goals.restore()
        self._transport.call_at(self._transport.now() + ORPHAN_TIMEOUT, self._recall_orphans)
        self.recheck(self._transport.now())

    def recheck(self, now: int) -> None:
        """Cancel what may not go on, and stop what it moves."""
        super().recheck(now)
        if not self.dry_run:
            self.stops.recheck(now, self.brake_reason)

    def cancel_receiver(self, flow: str, peer: Peer) -> MessageHandler | None:
        """Return what takes the cancels of a client."""
        if flow == UNAPPROVED and self.spec.block_unapproved and not self.dry_run:
            why = "not approved, its cancels are dropped"
            return lambda _message: self._problems.log(peer.node, why)
        return self._problems.decoding_receiver(peer, partial(self._on_cancel, peer))

    def server_receiver(self, part: Ros1ActionTopic, peer: Peer) -> MessageHandler | None:
        """Return what takes what the server publishes."""
        return self.server.receiver(part, peer)

    def on_server_lost(self, part: Ros1ActionTopic, peer: Peer) -> None:
        """Learn that the server does not publish a part any more."""
        self.server.on_lost(part, peer)

    def _subscribe_done(self) -> None:
        """Know that a goal is done from its own result, whatever else the plan names."""
        if self.spec.done != ros1_topic_name(self.name, Ros1ActionTopic.RESULT):
            super()._subscribe_done()

    def _reaches(self, node: str) -> bool:
        """Tell whether goals and cancels reach a node."""
        return self.endpoints.outputs.reaches(node) and self._topics.reaches_server(node)

    def _on_server_goal(self, _id: bytes) -> None:
        if self.brake_reason:
            self.recheck(self._transport.now())

    def _recall_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended, once their clients are back."""
        for goal in self.goals.registry:
            if goal.stage is GoalStage.WAITING and not goal.message:
                self._replies.finish(goal, RECALLED, "the guard was restarted")

    def _goal_receiver(self, flow: str, peer: Peer) -> MessageHandler:
        """Return what takes the goals of a client, or those that the server gives itself."""
        if self.endpoints.is_successor(peer):
            return self._problems.decoding_receiver(peer, self.server.on_goal)
        take = self._problems.decoding_receiver(peer, partial(self._on_goal, flow, peer))
        return self.endpoints.filter_latched(peer, take)

    def _on_goal(self, flow: str, peer: Peer, message: bytes) -> None:
        now, goals = self._transport.now(), self.goals.registry
        goal_id = read_goal(message)
        if not goal_id.id:
            goal_id = GoalID(self._generate_id(now), goal_id.stamp)
            message = with_goal_id(message, goal_id)
        if why := goals.rejection_reason(goal_id.id, peer.node, now):
            self._problems.log(peer.node, why)
            return
        goal = Goal(goal_id.id, goal_id.stamp, flow, peer.node, message, last_seen=now)
        goals.add(goal)
        self._decide_goal(goal, now)
        self.goals.store_soon()

    def _decide_goal(self, goal: Goal, now: int) -> None:
        is_ready = self.server.state.is_ready
        if self.goals.registry.was_cancelled_early(goal, now):
            self._replies.finish(goal, RECALLED, "cancelled by its client")
        elif why := self.goals.refusal_reason(goal, is_server_ready=is_ready):
            self._replies.finish(goal, REJECTED, why)
        else:
            verdict = self.receive(goal.flow, goal.message)
            if verdict is None or verdict.decision is Decision.DROP:
                why = verdict.reason if verdict else "internal error"
                self._replies.finish(goal, REJECTED, why)
            elif verdict.decision is Decision.HOLD:
                self._replies.publish_soon()

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        goal_id, goals = read_goal(message), self.goals.registry
        stamp = goals.monotonic_stamp(goal_id.stamp)
        if stamp != goal_id.stamp:
            message = with_goal_id(message, GoalID(goal_id.id, stamp))
        super()._on_passed(flow, message, now)
        if goal := goals.find(goal_id.id):
            goals.mark_sent(goal, now)
            self.goals.queue.start(goal)
            self.goals.store_soon()

    def _on_dropped_goal(self, message: bytes, verdict: Verdict) -> None:
        goal = self.goals.registry.find(read_goal(message).id)
        if goal and goal.stage is GoalStage.WAITING:
            self._replies.finish(goal, RECALLED, verdict.reason)

    def _on_cancel(self, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        if self.dry_run:
            self._topics.publish_cancel(message)
        goal_id = read_cancel(message)
        targets = self.goals.registry.cancel_targets(peer.node, goal_id.id, goal_id.stamp, now)
        for goal in targets:
            if goal.stage is GoalStage.WAITING:
                self.pipeline.withdraw(goal.message, "cancelled by its client", now)
            else:
                self.server.cancel(goal.id)

    def _generate_id(self, now: int) -> bytes:
        self._generated_ids += 1
        return f"{self.nodes[0]}-{self._generated_ids}-{now // SECOND}.{now % SECOND:09}".encode()


def _goal_label(goal: Goal) -> str:
    return f"goal {goal.id.decode(errors='replace')[:128]!r} of {goal.client}"
