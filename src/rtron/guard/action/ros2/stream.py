"""A guarded action of ROS 2: to its clients the guard is the server, to the server the client.

As with an action of ROS 1 a goal goes through a pipeline, one that waits is told as accepted, and
each goal is answered once. A cancel touches only the goals of the client that sends it.
"""

import logging
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from rtron.guard.action.common.action_goals import ORPHAN_TIMEOUT, ActionGoals, GoalQueue
from rtron.guard.action.common.goal_stops import GoalStops
from rtron.guard.action.common.problem_log import MAX_NAME_LENGTH, ProblemLog
from rtron.guard.action.ros2.client_cancels import ClientCancels
from rtron.guard.action.ros2.client_replies import ClientReplies
from rtron.guard.action.ros2.endpoints import (
    REJECTED,
    ActionEndpoints,
    CancelReply,
    CancelResponse,
    DecodeGoal,
    GoalReply,
)
from rtron.guard.action.ros2.goal_results import GoalTask
from rtron.guard.action.ros2.server_tracker import ServerTracker
from rtron.guard.core.stream import GuardedStream
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.transport.common.protocol import Peer
from rtron.messages.ros2.actions import ABORTED, CANCELED, GoalMessage
from rtron.policies.goals.registry import Goal, GoalStage
from rtron.vocabulary import (
    SECOND,
    UNAPPROVED,
    Decision,
    Ros2ActionEntity,
    Stream,
    Verdict,
    matches_node,
)

if TYPE_CHECKING:
    from rtron.guard.transport.ros2.action_server import ResultResponder

log = logging.getLogger(__name__)

_SERVER_TIMEOUT = 10 * SECOND
CreateEndpoints = Callable[[Stream, str, "Ros2ActionStream"], ActionEndpoints]
"""Returns the ends of a stream's action, of one of the guard's nodes; not open yet."""


class Ros2ActionStream(GuardedStream):
    """A guarded stream of goals that come as requests, with all else of the action beside it."""

    def __init__(
        self, stream: Stream, context: StreamContext, create_endpoints: CreateEndpoints
    ) -> None:
        super().__init__(stream, context)
        self._problems = ProblemLog(stream.action, context.transport)
        queue = GoalQueue(
            self.pipeline,
            context.transport,
            self.on_action_done,
            lambda: self.server.may_be_sent_goals,
        )
        self.goals = ActionGoals(self.spec, queue, context, _goal_label)
        self._action_endpoints = create_endpoints(self.spec, self.nodes[0], self)
        self.replies = ClientReplies(self._action_endpoints, self.goals, context)
        self.server = ServerTracker(
            self._action_endpoints, self.goals, self.replies, self._problems, context
        )
        self._cancels = ClientCancels(self.replies, self.server, self.pipeline, context.transport)
        self.stops = GoalStops(self.goals, self.pipeline, self.server)
        self.goals.on_end, self.goals.on_result = self.stops.update, self._measure_goal_end
        queue.on_server_goal.append(self._on_server_goal)
        self.pipeline.on_dropped = self._on_dropped_goal

    @property
    def name(self) -> str:
        """The action's name."""
        return self.spec.action

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        server = self.server
        doubt = {"server in doubt": server.doubt} if server.doubt else {}
        return self.goals.details(server.node if server.is_available else "") | doubt

    def open(self) -> None:
        """Join the graph; the goals that waited with the guard before went with it."""
        super().open()
        self.replies.restore()
        now = self._transport.now()
        self._transport.call_at(now + ORPHAN_TIMEOUT, self._abort_orphans)
        self._transport.call_at(now + _SERVER_TIMEOUT, self.server.finish_without_server)
        self.recheck(now)

    def recheck(self, now: int) -> None:
        """Cancel what may not go on, and stop what it moves."""
        super().recheck(now)
        if not self.dry_run:
            self.stops.recheck(now, self.brake_reason)

    def _join_graph(self) -> None:
        self.endpoints.type_info = self._action_endpoints.type_info
        self._action_endpoints.open()

    def _on_server_goal(self, _id: bytes) -> None:
        if self.brake_reason:
            self.recheck(self._transport.now())

    def _abort_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended."""
        for task in list(self.replies.tasks.values()):
            goal = task.goal
            if goal.client and goal.stage is GoalStage.WAITING and not goal.message:
                self.replies.finish(task, ABORTED, reason="the guard was restarted")

    # Whose a request is

    def _identify_client(self, flow: str, peer: Peer) -> tuple[str, str]:
        """Return the flow that a request counts for, and what its client is called here."""
        planned_flow = next((each for each in self.spec.flows if each.name == flow), None)
        if planned_flow and peer.verified and matches_node(planned_flow.publisher, peer.node):
            return flow, peer.node
        location = f"on the private name of {flow}" if planned_flow else "under the public name"
        name = peer.node[:MAX_NAME_LENGTH]
        if self._problems.allows("stranger", name):
            log.warning("%s: unapproved client %s %s", self.name, name, location)
        self.endpoints.count_stranger(name)
        return UNAPPROVED, f"{UNAPPROVED} {peer.node}"

    def _is_shut_out(self, flow: str) -> bool:
        return flow == UNAPPROVED and self.spec.block_unapproved and not self.dry_run

    # Goals

    def on_goal_request(self, flow: str, peer: Peer, decode: DecodeGoal, reply: GoalReply) -> None:
        """Take a goal that was sent under the name of a flow; a stranger's is not even read."""
        flow, client = self._identify_client(flow, peer)
        if self._is_shut_out(flow):
            self.receive(flow, b"")
            reply(None)
        else:
            self._accept_goal(flow, client, peer, decode(), reply)

    def _accept_goal(
        self, flow: str, client: str, peer: Peer, message: GoalMessage, reply: GoalReply
    ) -> None:
        id, now = message.id, self._transport.now()
        why = self._type_mismatch() or self.goals.registry.rejection_reason(id, client, now)
        if why:
            self._problems.log(peer.node, why)
            reply(None)
            return
        goal = Goal(id, time.time_ns(), flow, client, message, last_seen=now)
        self._decide_goal(self.replies.add(goal, reply))
        self.goals.store_soon()

    def _type_mismatch(self) -> str:
        """Return why no goal can be judged, or nothing."""
        matches = self.endpoints.fits_rules(self._action_endpoints.type_info)
        text = "goals of this type are not what the plan's rules are written for"
        return "" if matches else text

    def _decide_goal(self, task: GoalTask) -> None:
        goal = task.goal
        if self.dry_run:
            self.server.send(goal)
        if why := self._refusal_reason(goal):
            self.replies.finish(task, ABORTED, reason=why)
            return
        verdict = self.receive(goal.flow, goal.message)
        if self.dry_run:
            return
        if verdict is None or verdict.decision is Decision.DROP:
            why = verdict.reason if verdict else "internal error"
            self.replies.finish(task, ABORTED, reason=why)
        elif verdict.decision is Decision.HOLD and goal.stage is GoalStage.WAITING:
            self.replies.accept(task, goal.stamp)

    def _refusal_reason(self, goal: Goal) -> str:
        server = self.server
        if server.is_available and not server.may_be_sent_goals:
            return server.doubt
        return self.goals.refusal_reason(goal, is_server_ready=server.is_ready)

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        super()._on_passed(flow, message, now)
        goal = self.goals.registry.find(message.id) if isinstance(message, GoalMessage) else None
        if goal is None:
            self._transport.call_at(now, self.on_action_done)
            return
        self.goals.queue.start(goal)
        if not self.dry_run:
            self.server.send(goal)

    def _send_message(self, flow: str, message: bytes) -> None:
        """Publish nothing on topics: goals are sent one by one."""

    def _on_dropped_goal(self, message: bytes, verdict: Verdict) -> None:
        task = self.replies.tasks.get(message.id) if isinstance(message, GoalMessage) else None
        if task and task.goal.stage is GoalStage.WAITING:
            status = CANCELED if task.is_cancelled else ABORTED
            self.replies.finish(task, status, reason=verdict.reason)

    # Results and cancels

    def on_result_request(self, flow: str, peer: Peer, id: bytes, reply: "ResultResponder") -> None:
        """Take a request for a goal's result."""
        _, client = self._identify_client(flow, peer)
        self.replies.request_result(id, client, reply)

    def on_cancel_request(
        self, flow: str, peer: Peer, id: bytes, stamp: int, reply: CancelReply
    ) -> None:
        """Take a cancel: it means goals of the client that sends it, and no others."""
        flow, client = self._identify_client(flow, peer)
        if self.dry_run:
            self._action_endpoints.cancel(id, stamp, reply)
        elif self._is_shut_out(flow):
            self._problems.log(peer.node, "not approved, its cancels are rejected")
            reply(CancelResponse(REJECTED))
        else:
            self._cancels.request(client, id, stamp, reply)

    # The server

    def on_server_available(self, node: str, incarnation: bytes) -> None:
        """Learn that the server is there."""
        self.stops.repeat(node)
        self.server.on_available(node, incarnation)

    def on_server_lost(self) -> None:
        """Learn that the server is not there any more."""
        self.server.on_lost()

    def on_server_doubt(self, reason: str) -> None:
        """Learn that not only the server may answer, and why; "" when it is alone again."""
        self.server.on_doubt(reason)

    def on_server_message(self, end: Ros2ActionEntity, message: bytes) -> None:
        """Take what the server publishes on its topics."""
        self.server.on_message(end, message)


class ObservedActionStream(GuardedStream):
    """Stands in the reports of the guard, and sees nothing: goals go from client to server."""

    def open(self) -> None:
        """Stay out of the graph."""
        log.warning("%s: a plan with mode observe cannot see goals of ROS 2", self.spec.topic)

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        return {"goals": "requests, which nobody else can see"}


def _goal_label(goal: Goal) -> str:
    return f"goal {goal.id.hex()} of {goal.client or 'the server itself'}"
