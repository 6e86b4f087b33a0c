"""An action of ROS 1 as its server sees it: what it publishes on its topics, and its cancels."""

import logging
from functools import partial

from rtron.errors import InputError
from rtron.guard.action.common.action_goals import ActionGoals
from rtron.guard.action.common.problem_log import ProblemLog
from rtron.guard.action.ros1.client_replies import ClientReplies
from rtron.guard.action.ros1.server_state import ServerState
from rtron.guard.action.ros1.topics import ActionTopics
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.transport.common.protocol import MessageHandler, Peer
from rtron.messages.ros1.actions import ABORTED, cancel_message, read_goal, read_result, stamp_of
from rtron.policies.goals.status_list import (
    LOST_TIMEOUT,
    TERMINAL_STATUSES,
    add_discovered_goal,
    compare_status_list,
    lost_goals,
)
from rtron.vocabulary import Ros1ActionTopic

log = logging.getLogger(__name__)


class ServerTracker:
    """Follows what becomes of goals at the server; each is answered once, by it or by the guard."""

    def __init__(
        self,
        state: ServerState,
        topics: ActionTopics,
        goals: ActionGoals,
        replies: ClientReplies,
        problems: ProblemLog,
        context: StreamContext,
    ) -> None:
        self.state = state
        self._topics = topics
        self._goals = goals
        self._replies = replies
        self._problems = problems
        self._transport = context.transport
        self._dry_run = context.dry_run
        self._was_ready = False

    @property
    def node(self) -> str:
        """The node that serves the action, "" while none does."""
        return self.state.node

    def receiver(self, part: Ros1ActionTopic, peer: Peer) -> MessageHandler | None:
        """Return what takes what the server publishes."""
        if part is Ros1ActionTopic.RESULT:
            try:
                self.state.learn_result(peer.info)
            except InputError as error:
                self._problems.log(peer.node, str(error))
                return None
            return self._problems.decoding_receiver(peer, self._on_result)
        if part is Ros1ActionTopic.STATUS:
            self.state.node = peer.node
            return self._problems.decoding_receiver(peer, self._on_status)
        return partial(self._topics.publish, part)

    def on_lost(self, part: Ros1ActionTopic, peer: Peer) -> None:
        """Learn that the server does not publish a part any more."""
        if part is Ros1ActionTopic.STATUS and peer.node == self.state.node:
            log.warning("%s: the server %s is gone", self._goals.name, peer.node)
            now = self._transport.now()
            self.state.clear()
            self._was_ready = False
            self._topics.clear_latched_status()
            self._goals.queue.await_server(now)
            self._goals.registry.forget_unread()
            self._transport.call_at(now + LOST_TIMEOUT, self._finish_lost_goals)

    def cancel(self, id: bytes) -> None:
        """Ask the server to cancel a goal."""
        if not self._dry_run:
            self._topics.publish_cancel(cancel_message(id))

    def on_goal(self, message: bytes) -> None:
        """Take notice of a goal that the server gives itself, as move_base does."""
        now = self._transport.now()
        goal_id, goals = read_goal(message), self._goals.registry
        if goal_id.id and not goals.rejection_reason(goal_id.id, "", now):
            self._goals.start_server_goal(
                add_discovered_goal(goals, goal_id.id, now, goal_id.stamp), now
            )

    def _on_status(self, message: bytes) -> None:
        now, goals = self._transport.now(), self._goals.registry
        self.state.update(message, now)
        changes = compare_status_list(goals, self.state.listed_goals, now)
        for id in changes.resurrected:
            self.cancel(id)
        for goal in changes.discovered:
            goals.monotonic_stamp(stamp_of(message, goal.id))
            self._goals.start_server_goal(goal, now)
        for goal in changes.finished:
            if not goal.client:
                self._goals.end(goal, now)
            self._goals.queue.end_turn(goal)
        self._finish_lost_goals()
        self._repeat_cancels()
        if self.state.is_ready:
            self._goals.queue.resume()
        self._replies.publish_status()

    def _repeat_cancels(self) -> None:
        """Cancel again what a server could not hear that has been found only now."""
        was_ready, self._was_ready = self._was_ready, self.state.is_ready
        for goal in self._goals.registry if self._was_ready and not was_ready else ():
            if goal.cancel_reason:
                self.cancel(goal.id)

    def _on_result(self, message: bytes) -> None:
        now, goals = self._transport.now(), self._goals.registry
        status = read_result(message)
        id = status.goal.id
        self._goals.on_result(id)
        goal = goals.find(id)
        if goal is None and goals.is_finished(id):
            return
        if goal is None:
            goals.remember_finished(id, "", now)
        else:
            self._goals.end(goal, now)
            self._replies.list_ended(status)
        self._goals.store()
        self._replies.forward(goal.client if goal else "", message)
        if goal:
            self._goals.queue.end_turn(goal)

    def _finish_lost_goals(self) -> None:
        """Answer the goals that the server has no more, and those whose result does not come."""
        state = self.state
        last_status_time = state.last_status_time if state.node else self._transport.now()
        for goal in lost_goals(self._goals.registry, last_status_time):
            is_terminal = goal.status in TERMINAL_STATUSES
            status = goal.status if is_terminal else ABORTED
            self._replies.finish(goal, status, "the server has lost it")
            self._goals.queue.end_turn(goal)
