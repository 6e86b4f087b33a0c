"""What there is to do for one goal of an action of ROS 2: whom to answer, and what to ask."""

from dataclasses import dataclass, field

from rtron.guard.action.ros2.endpoints import MAX_PENDING_RESULTS, GoalReply, ResultReply
from rtron.policies.goals.registry import Goal


@dataclass(slots=True, eq=False)
class GoalTask:
    """A goal, and who waits for what.

    `asked` is the client that does not know yet whether its goal is accepted. `is_accepted` tells
    whether the server has it, `is_cancelled` that its client has given it up, `must_cancel` that the
    server is to cancel it as soon as it has it, `is_over` that it says that the goal has ended.
    """

    goal: Goal
    goal_reply: GoalReply | None = None
    is_accepted: bool = False
    is_cancelled: bool = False
    must_cancel: bool = False
    is_over: bool = False
    result_replies: list[ResultReply] = field(default_factory=list)

    @property
    def is_acknowledged(self) -> bool:
        """Whether the client knows that its goal is accepted."""
        return self.goal_reply is None

    def accept(self, stamp: int) -> None:
        """Tell the client since when its goal is accepted, if it does not know."""
        reply, self.goal_reply = self.goal_reply, None
        if reply:
            self.goal.stamp = stamp
            reply(stamp)

    def reject(self) -> None:
        """Tell the client that its goal is not accepted, if it does not know better."""
        reply, self.goal_reply = self.goal_reply, None
        if reply:
            reply(None)

    def add_result_request(self, reply: ResultReply) -> bool:
        """Let a request wait for the result; False if too many do."""
        has_room = len(self.result_replies) < MAX_PENDING_RESULTS
        if has_room:
            self.result_replies.append(reply)
        return has_room

    def reply_with_result(self, status: int, result: object | None) -> None:
        """Answer all who wait for the result."""
        replies, self.result_replies = self.result_replies, []
        for reply in replies:
            reply(status, result)
