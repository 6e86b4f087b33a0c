"""Goals without an id, as on `move_base_simple/goal`: followed to the goal that appears next."""

import logging
from collections.abc import Callable
from functools import partial
from typing import TypeVar

from rtron.errors import WireError
from rtron.guard.action.common.turns import TurnSharingStream
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import Observations
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import MessageHandler, Output, Peer, Transport
from rtron.messages.ros1.actions import cancel_message, read_result, read_statuses
from rtron.policies.goals.goal_tracker import GoalTracker
from rtron.policies.goals.status_list import TERMINAL_STATUSES
from rtron.vocabulary import (
    SECOND,
    SERVER_FLOW,
    Ros1ActionTopic,
    Stream,
    normalise_type,
    ros1_topic_name,
)

log = logging.getLogger(__name__)

_APPEARANCE_TIMEOUT = 5 * SECOND

T = TypeVar("T")

_CANCEL, _STATUS = "actionlib_msgs/GoalID", "actionlib_msgs/GoalStatusArray"


def action_of_result(stream: Stream) -> str:
    """Return the action whose result tells that a goal of the stream is done, or nothing."""
    if stream.action or not stream.done or not stream.done.endswith("/result"):
        return ""
    return stream.done.removesuffix("/result")


class SimpleGoalStream(GuardedStream):
    """A guarded stream whose messages become goals of an action that has a guard or has none."""

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
        self._goal_matcher = GoalTracker()
        self._guarded_action: TurnSharingStream | None = None
        self._cancelled_goal: bytes | None = None
        self._sent_count = 0
        self._cancel_output: Output | None = None
        self._log_throttle = LogThrottle()

    @property
    def action(self) -> str:
        """The name of the action that the goals become."""
        return action_of_result(self.spec)

    def attach(self, action: TurnSharingStream) -> None:
        """Hear of goals from the guard of the action, which nobody else hears first."""
        self._guarded_action = action
        action.on_goal_start.append(self._occupy_turn)
        action.on_server_goal.append(self._on_server_goal)
        action.on_server_goal_end.append(self._on_goal_end)
        action.on_turn_free.append(self._on_turn_free)

    def recheck(self, now: int) -> None:
        """Cancel the goal in progress if what asked for it may not go on."""
        super().recheck(now)
        goal, flow = self._goal_matcher.goal, self._goal_matcher.flow
        if goal in (None, self._cancelled_goal) or self.dry_run:
            return
        if why := self.pipeline.refusal(flow, now):
            self._cancelled_goal = goal
            log.warning("%s: goal %r is cancelled: %s", self.spec.topic, goal[:128], why)
            self._cancel_goal(goal, why)

    def _cancel_goal(self, goal: bytes, why: str) -> None:
        if self._guarded_action:
            self._guarded_action.stop_server_goal(goal, why)
        elif self._cancel_output:
            self._cancel_output.publish(cancel_message(goal))

    def _subscribe_done(self) -> None:
        if not self._guarded_action:
            super()._subscribe_done()
            self._subscribe_action()

    def _subscribe_action(self) -> None:
        """Hear of goals from an action that has no guard."""
        status = ros1_topic_name(self.action, Ros1ActionTopic.STATUS)
        self._subscribe_successors(status, _STATUS, self._connect_status)
        topic = ros1_topic_name(self.action, Ros1ActionTopic.CANCEL)
        info = standard_info(_CANCEL, self._transport.encoding)
        self._cancel_output = self._transport.advertise(self.nodes[0], topic, _CANCEL)
        if info:
            self._cancel_output.learn_type(info)

    def _connect_done(self, peer: Peer) -> MessageHandler | None:
        take = super()._connect_done(peer)
        is_result = normalise_type(peer.info.type).endswith("ActionResult")
        return self._on_result if take and is_result else take

    def _connect_status(self, peer: Peer) -> MessageHandler | None:
        return self._on_status if super()._connect_done(peer) else None

    def _on_passed(self, flow: str, message: bytes, now: int) -> None:
        super()._on_passed(flow, message, now)
        self._goal_matcher.expect_goal(flow)
        self._sent_count += 1
        if self._guarded_action:
            self._guarded_action.expect_server_goal()
        self._transport.call_at(
            now + _APPEARANCE_TIMEOUT, partial(self._check_goal_appeared, self._sent_count)
        )

    def _check_goal_appeared(self, sent_count: int) -> None:
        """Let others go if the server has made no goal of what was said."""
        if sent_count == self._sent_count and self._goal_matcher.is_expecting:
            log.warning("%s: no goal has appeared", self.spec.topic)
            self._goal_matcher.stop_expecting()
            if self._guarded_action:
                self._guarded_action.stop_expecting(partial(self._on_action_done, b""))
            else:
                self._on_action_done(b"")

    def _on_server_goal(self, id: bytes) -> None:
        """Take a goal that the server has given itself; nobody here may have asked for it."""
        self._goal_matcher.add_goal(id)
        if id != self._goal_matcher.goal:
            self._occupy_turn()

    def _on_turn_free(self) -> None:
        """Let goals go again that waited for one of the action."""
        if self.pipeline.owner == SERVER_FLOW:
            self._on_action_done(b"")

    def _occupy_turn(self) -> None:
        """Let goals wait for one of the action."""
        self.pipeline.occupy(SERVER_FLOW, self._transport.now())

    def _on_status(self, message: bytes) -> None:
        statuses = self._decode(read_statuses, message) or {}
        self._goal_matcher.update_goals(statuses)
        for id in [id for id, status in statuses.items() if status in TERMINAL_STATUSES]:
            self._on_goal_end(id)

    def _on_result(self, message: bytes) -> None:
        result = self._decode(read_result, message)
        if result:
            self._on_goal_end(result.goal.id)

    def _decode(self, read: Callable[[bytes], T], message: bytes) -> T | None:
        try:
            return read(message)
        except WireError as error:
            if self._log_throttle.allows("unreadable", self._transport.now()):
                log.warning("%s: what the action says cannot be read: %s", self.spec.topic, error)
            return None

    def _on_goal_end(self, id: bytes) -> None:
        if self._goal_matcher.finish_goal(id):
            self._on_action_done(b"")
