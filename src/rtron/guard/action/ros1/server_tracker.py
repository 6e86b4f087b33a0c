"""An action of ROS 1 as its server sees it: what it says on its topics, and what it is told."""

import logging
from collections.abc import Callable
from functools import partial

from rtron.errors import InputError, WireError
from rtron.guard.action.common.stream import ActionStream
from rtron.guard.action.ros1.client_replies import ClientReplies
from rtron.guard.action.ros1.server_state import ServerState
from rtron.guard.action.ros1.topics import ActionListener, ActionTopics
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import Observations
from rtron.guard.transport.common.protocol import MessageHandler, Peer, Transport
from rtron.messages.ros1.actions import ABORTED, cancel_message, read_goal, read_result, stamp_of
from rtron.policies.goals.registry import Goal
from rtron.policies.goals.status_list import (
    LOST_TIMEOUT,
    TERMINAL_STATUSES,
    add_discovered_goal,
    compare_status_list,
    lost_goals,
)
from rtron.vocabulary import Ros1ActionTopic, Stream, matches_node

log = logging.getLogger(__name__)


class ServerTracker(ActionStream, ActionListener):
    """Follows what becomes of goals at the server; each is answered once, by it or by the guard."""

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
        self.server = ServerState()
        self._topics = ActionTopics(self.spec, self.nodes[0], transport, self)
        self._replies = ClientReplies(
            self._topics, self.server, self.goals, transport, self._is_server_visible
        )
        self._was_server_ready = False

    def server_receiver(self, part: Ros1ActionTopic, peer: Peer) -> MessageHandler | None:
        """Return what takes what the server says."""
        if part is Ros1ActionTopic.RESULT:
            try:
                self.server.learn_result(peer.info)
            except InputError as error:
                self._log_problem(peer, str(error))
                return None
            return self._decoding_receiver(peer, self._on_result)
        if part is Ros1ActionTopic.STATUS:
            self.server.node = peer.node
            return self._decoding_receiver(peer, self._on_status)
        return partial(self._topics.publish, part)

    def on_server_lost(self, part: Ros1ActionTopic, peer: Peer) -> None:
        """Learn that the server does not publish a part any more."""
        if part is Ros1ActionTopic.STATUS and peer.node == self.server.node:
            log.warning("%s: the server %s is gone", self.name, peer.node)
            now = self._transport.now()
            self.server.clear()
            self._was_server_ready = False
            self._topics.clear_latched_status()
            self._await_server(now)
            self._transport.call_at(now + LOST_TIMEOUT, self._reply_to_lost)

    def _decoding_receiver(self, peer: Peer, take: Callable[[bytes], None]) -> MessageHandler:
        """Return what takes messages, and drops those that cannot be read."""

        def receive(message: bytes) -> None:
            try:
                take(message)
            except WireError as error:
                self._log_problem(peer, f"what it says cannot be read: {error}")

        return receive

    def _on_status(self, message: bytes) -> None:
        now = self._transport.now()
        self.server.update(message, now)
        changes = compare_status_list(self.goals, self.server.listed_goals, now)
        for id in changes.resurrected:
            self._cancel_at_server(id)
        for goal in changes.discovered:
            self.goals.monotonic_stamp(stamp_of(message, goal.id))
            self._on_foreign_goal(goal, now)
        for goal in changes.finished:
            if not goal.client:
                self._end(goal, now)
            self._end_turn(goal)
        self._reply_to_lost()
        self._repeat_cancels()
        self._resume_with_server()
        self._replies.publish_status()

    def _repeat_cancels(self) -> None:
        """Say once more what a server could not hear that has been found only now."""
        was_ready, self._was_server_ready = self._was_server_ready, self._is_server_ready()
        for goal in self.goals if self._was_server_ready and not was_ready else ():
            if goal.cancel_reason:
                self._cancel_at_server(goal.id)

    def _on_server_goal_message(self, message: bytes) -> None:
        """Take notice of a goal that the server gives itself, as move_base does."""
        now = self._transport.now()
        goal_id = read_goal(message)
        if goal_id.id and not self.goals.rejection_reason(goal_id.id, "", now):
            self._on_foreign_goal(
                add_discovered_goal(self.goals, goal_id.id, now, goal_id.stamp), now
            )

    def _on_result(self, message: bytes) -> None:
        now = self._transport.now()
        status = read_result(message)
        id = status.goal.id
        if self.measurement:
            self.measurement.finish_goal(id, now)
        goal = self.goals.find(id)
        if goal is None and self.goals.is_finished(id):
            return
        if goal is None:
            self.goals.remember_finished(id, "", now)
        else:
            self._end(goal, now)
            self._replies.list_ended(status)
        self._goal_handover.store()
        self._topics.publish(Ros1ActionTopic.RESULT, message)
        if goal:
            self._end_turn(goal)

    def _reply_to_lost(self) -> None:
        """Answer the goals that the server has no more, and those whose result does not come."""
        last_status_time = (
            self.server.last_status_time if self.server.node else self._transport.now()
        )
        for goal in lost_goals(self.goals, last_status_time):
            is_terminal = goal.status in TERMINAL_STATUSES
            self._reply(goal, goal.status if is_terminal else ABORTED, "the server has lost it")
            self._end_turn(goal)

    def _reply(self, goal: Goal, status: int, reason: str) -> None:
        """End a goal in the server's place."""
        self._end(goal, self._transport.now())
        if goal.client and not self.dry_run:
            log.info("%s: %s: %s", self.name, self._goal_label(goal), reason)
            self._replies.reply(goal, status, reason)

    def _cancel_at_server(self, id: bytes) -> None:
        if not self.dry_run:
            self._topics.publish_cancel(cancel_message(id))

    def _server_node(self) -> str:
        return self.server.node

    def _is_server_ready(self) -> bool:
        node = self.server.node
        return bool(node) and self._outputs.reaches(node) and self._topics.reaches_server(node)

    def _is_server_visible(self) -> bool:
        return self._is_server_ready() and self.server.empty_result is not None

    def _is_planned_server(self, peer: Peer) -> bool:
        return peer.verified and any(matches_node(s, peer.node) for s in self.spec.successors)

    def _goal_label(self, goal: Goal) -> str:
        return f"goal {goal.id.decode(errors='replace')[:128]!r} of {goal.client}"
