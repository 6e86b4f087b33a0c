"""A guarded action of ROS 2: to its clients the guard is the server, to the server the client.

As with an action of ROS 1 a goal goes through a pipeline, one that waits is told as accepted, and
each goal is answered once. A cancel touches only the goals of the client that sends it.
"""

import logging
import time
from collections.abc import Iterator
from functools import partial

from rtron.guard.action.common.stream import MAX_NAME_LENGTH, ORPHAN_TIMEOUT
from rtron.guard.action.ros2.cancel_requests import CancelRequest
from rtron.guard.action.ros2.client_replies import GoalTask
from rtron.guard.action.ros2.endpoints import (
    REJECTED,
    TERMINATED,
    UNKNOWN_GOAL,
    ActionTransport,
    CancelReply,
    CancelResponse,
    DecodeGoal,
    GoalMessage,
    GoalReply,
    ResultReply,
)
from rtron.guard.action.ros2.places import ResultRequestHandover
from rtron.guard.action.ros2.server_tracker import ServerTracker
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import Observations
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Peer, Transport
from rtron.messages.ros2.actions import ABORTED, CANCELED, NO_ID, UNKNOWN
from rtron.policies.goals.registry import Goal, GoalStage
from rtron.vocabulary import SECOND, UNAPPROVED, Decision, Stream, Verdict, matches_node

log = logging.getLogger(__name__)

_SERVER_TIMEOUT = 10 * SECOND
_CANCEL_TIMEOUT = 5 * SECOND
_MAX_STRANGERS = 32


class Ros2ActionStream(ServerTracker):
    """A guarded stream of goals that come as requests, with all else of the action beside it."""

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        observations: Observations,
        handover: HandoverState,
        action_transport: ActionTransport,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(
            stream, transport, observations, handover, action_transport, dry_run=dry_run
        )
        self._result_handover = ResultRequestHandover(self.name, self._tasks, handover, transport)

    def open(self) -> None:
        """Join the graph."""
        self._type_info = self._action_endpoints.type_info
        self._action_endpoints.open()
        self._is_open = True
        for why in self._brake_reasons.values():
            self._stop_robot(why)
        self._restore_goals()
        self.recheck(self._transport.now())

    def _restore_goals(self) -> None:
        """Go on with the goals of the guard before; those that waited went with it."""
        now = self._transport.now()
        for goal in self._inherit_goals():
            if goal.client:
                self._tasks[goal.id] = GoalTask(goal, is_accepted=goal.stage is GoalStage.SENT)
        self._result_handover.restore(self._action_endpoints.restore_reply)
        self._transport.call_at(now + ORPHAN_TIMEOUT, self._reply_to_orphans)
        self._transport.call_at(now + _SERVER_TIMEOUT, self._reply_without_server)

    def _reply_to_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended."""
        for task in list(self._tasks.values()):
            goal = task.goal
            if goal.client and goal.stage is GoalStage.WAITING and not goal.message:
                self._finish(task, ABORTED, reason="the guard was restarted")

    # Whose a request is

    def _identify_client(self, flow: str, peer: Peer) -> tuple[str, str]:
        """Return the flow that a request counts for, and what its client is called here."""
        planned_flow = next((each for each in self.spec.flows if each.name == flow), None)
        if planned_flow and peer.verified and matches_node(planned_flow.publisher, peer.node):
            return flow, peer.node
        location = f"on the private name of {flow}" if planned_flow else "under the public name"
        name = peer.node[:MAX_NAME_LENGTH]
        if self._may_log("stranger", name):
            log.warning("%s: unapproved client %s %s", self.name, name, location)
        if name in self.strangers or len(self.strangers) < _MAX_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        return UNAPPROVED, f"{UNAPPROVED} {peer.node}"

    def _is_shut_out(self, flow: str) -> bool:
        return flow == UNAPPROVED and self.spec.block_unapproved and not self.dry_run

    # Goals

    def on_goal_request(self, flow: str, peer: Peer, decode: DecodeGoal, reply: GoalReply) -> None:
        """Take a goal that was sent under the name of a flow; a stranger's is not even read."""
        flow, client = self._identify_client(flow, peer)
        if self._is_shut_out(flow):
            self._receive(flow, b"")
            reply(None)
        else:
            self._accept_goal(flow, client, peer, decode(), reply)

    def _accept_goal(
        self, flow: str, client: str, peer: Peer, message: GoalMessage, reply: GoalReply
    ) -> None:
        id, now = message.id, self._transport.now()
        if why := self._type_mismatch() or self.goals.rejection_reason(id, client, now):
            self._log_problem(peer, why)
            reply(None)
            return
        goal = Goal(id, time.time_ns(), flow, client, message, last_seen=now)
        self.goals.add(goal)
        task = self._tasks[id] = GoalTask(goal, reply)
        self._decide_goal(task)
        self._goal_handover.store_soon()

    def _type_mismatch(self) -> str:
        """Return why no goal can be judged, or nothing."""
        matches = self.dry_run or self._rules_md5sum in (
            "",
            self._action_endpoints.type_info.md5sum,
        )
        text = "goals of this type are not what the plan's rules are written for"
        return "" if matches else text

    def _decide_goal(self, task: GoalTask) -> None:
        goal = task.goal
        if self.dry_run:
            self._send_goal(goal)
        if why := self._refusal_reason(goal):
            self._finish(task, ABORTED, reason=why)
            return
        verdict = self._receive(goal.flow, goal.message)
        if self.dry_run:
            return
        if verdict is None or verdict.decision is Decision.DROP:
            self._finish(task, ABORTED, reason=verdict.reason if verdict else "internal error")
        elif verdict.decision is Decision.HOLD and goal.stage is GoalStage.WAITING:
            task.accept(goal.stamp)
            self._status_publisher.publish_soon()

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        goal = self.goals.find(message.id) if isinstance(message, GoalMessage) else None
        self._current_goal = goal or self._current_goal
        super()._on_passed(flow, message, now)
        if goal is None:
            self._transport.call_at(now, partial(self._on_action_done, b""))
        elif not self.dry_run:
            self._send_goal(goal)
        for notify in self.on_goal_start if goal else ():
            notify()

    def _send_message(self, flow: str, message: bytes) -> None:
        """Say nothing on topics: goals are sent one by one."""

    def _on_dropped_goal(self, message: bytes, verdict: Verdict) -> None:
        task = self._tasks.get(message.id) if isinstance(message, GoalMessage) else None
        if task and task.goal.stage is GoalStage.WAITING:
            status = CANCELED if task.is_cancelled else ABORTED
            self._finish(task, status, reason=verdict.reason)

    # Results and cancels

    def on_result_request(self, flow: str, peer: Peer, id: bytes, reply: ResultReply) -> None:
        """Take a request for a goal's result; nobody but its client gets it."""
        now = self._transport.now()
        _, client = self._identify_client(flow, peer)
        task = self._tasks.get(id)
        if task and task.goal.client == client:
            if task.add_result_request(reply):
                self._result_handover.store_soon()
            else:
                reply(UNKNOWN, None)
        elif cached := self._results.find(id, client, now):
            reply(cached.status, cached.result)
        else:
            reply(UNKNOWN, None)

    def on_cancel_request(
        self, flow: str, peer: Peer, id: bytes, stamp: int, reply: CancelReply
    ) -> None:
        """Take a cancel: it means goals of the client that sends it, and no others."""
        flow, client = self._identify_client(flow, peer)
        if self.dry_run:
            self._action_endpoints.cancel(id, stamp, reply)
        elif self._is_shut_out(flow):
            self._log_problem(peer, "not approved, its cancels are rejected")
            reply(CancelResponse(REJECTED))
        else:
            self._cancel_goals(client, id, stamp, reply)

    def _cancel_goals(self, client: str, id: bytes, stamp: int, reply: CancelReply) -> None:
        now = self._transport.now()
        tasks = list(self._tasks_to_cancel(client, id, stamp))
        if not tasks and id != NO_ID:
            ended = self._results.find(id, client, now)
            reply(CancelResponse(TERMINATED if ended else UNKNOWN_GOAL))
            return
        request = CancelRequest(reply)
        for task in tasks:
            self._cancel_task(task, request, now)
        request.close()
        self._transport.call_at(now + _CANCEL_TIMEOUT, request.expire)

    def _tasks_to_cancel(self, client: str, id: bytes, stamp: int) -> Iterator[GoalTask]:
        """Yield the goals of a client that its cancel means (action_msgs/CancelGoal)."""
        for task in self._tasks.values():
            goal = task.goal
            all_of_them = id == NO_ID and not stamp
            is_selected = all_of_them or goal.id == id or (stamp and goal.stamp <= stamp)
            if is_selected and goal.client == client:
                yield task

    def _cancel_task(self, task: GoalTask, request: CancelRequest, now: int) -> None:
        goal = task.goal
        if goal.stage is GoalStage.WAITING:
            task.is_cancelled = True
            request.add_canceling(goal.id, goal.stamp)
            if goal.message:
                self.pipeline.withdraw(goal.message, "cancelled by its client", now)
            else:
                self._finish(task, CANCELED, reason="cancelled by its client")
        else:
            self._cancel_requests.add(goal.id, request)
            self._cancel_at_server(goal.id)


class ObservedActionStream(GuardedStream):
    """Stands in the reports of the guard, and sees nothing: goals go from client to server."""

    def open(self) -> None:
        """Stay out of the graph."""
        text = "%s: its goals are requests, which only a guard that enforces sees"
        log.warning(text, self.spec.topic)

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        return {"goals": "requests, which nobody else can see"}
