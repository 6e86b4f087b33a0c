"""The goals of an action without a guard, as its topics tell them, for `move_base_simple/goal`."""

from rtron.guard.action.common.problem_log import ProblemLog
from rtron.guard.action.common.simple_goals import SimpleGoalStream
from rtron.guard.action.ros1.topics import CANCEL, STATUS
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.transport.common.protocol import MessageHandler, Output, Peer
from rtron.messages.ros1.actions import cancel_message, read_result, read_statuses
from rtron.policies.goals.status_list import TERMINAL_STATUSES
from rtron.vocabulary import Ros1ActionTopic, Stream, normalise_type, ros1_topic_name


def action_of_result(stream: Stream) -> str:
    """Return the action whose result tells that a goal of the stream is done, or nothing."""
    if stream.action or not stream.done or not stream.done.endswith("/result"):
        return ""
    return stream.done.removesuffix("/result")


class ActionTopicObserver:
    """Subscribes to an action's status and result, and publishes cancels."""

    sees_goals = True

    def __init__(self, action: str, context: StreamContext) -> None:
        self._action = action
        self._transport = context.transport
        self._cancel_output: Output | None = None

    def open(self, stream: SimpleGoalStream) -> None:
        """Join the graph."""
        self._stream = stream
        self._problems = ProblemLog(stream.spec.topic, self._transport)
        endpoints = stream.endpoints
        if stream.spec.done:
            endpoints.subscribe_successors(stream.spec.done, "", self._connect_result)
        status = ros1_topic_name(self._action, Ros1ActionTopic.STATUS)
        endpoints.subscribe_successors(status, STATUS, self._connect_status)
        topic = ros1_topic_name(self._action, Ros1ActionTopic.CANCEL)
        self._cancel_output = self._transport.advertise(stream.nodes[0], topic, CANCEL)
        info = standard_info(CANCEL, self._transport.encoding)
        if info:
            self._cancel_output.learn_type(info)

    def expect_goal(self) -> None:
        """Nobody else waits."""

    def stop_expecting(self, stream: SimpleGoalStream) -> None:
        """Let the next message go."""
        stream.on_action_done()

    def cancel(self, goal: bytes, why: str) -> None:
        """Publish a cancel."""
        del why
        if self._cancel_output:
            self._cancel_output.publish(cancel_message(goal))

    def _connect_result(self, peer: Peer) -> MessageHandler:
        if normalise_type(peer.info.type).endswith("ActionResult"):
            return self._problems.decoding_receiver(peer, self._on_result)
        return self._stream.on_action_done

    def _connect_status(self, peer: Peer) -> MessageHandler:
        return self._problems.decoding_receiver(peer, self._on_status)

    def _on_result(self, message: bytes) -> None:
        self._stream.on_goal_end(read_result(message).goal.id)

    def _on_status(self, message: bytes) -> None:
        statuses = read_statuses(message)
        self._stream.goal_tracker.update_goals(statuses)
        for id in [id for id, status in statuses.items() if status in TERMINAL_STATUSES]:
            self._stream.on_goal_end(id)
