"""What there is to do for one goal of an action of ROS 2: whom to answer, and what to ask."""

from dataclasses import dataclass, field

from rtron.guard.action.ros2.endpoints import MOST_UNANSWERED, AnswerGoal, AnswerResult
from rtron.policies.goals.registry import Goal


@dataclass(slots=True, eq=False)
class Task:
    """A goal, and who waits for what.

    `asked` is the client that does not know yet whether its goal is accepted. `accepted` tells
    whether the server has it, `cancelled` that its client has given it up, `to_cancel` that the
    server is to cancel it as soon as it has it, `over` that it says that the goal has ended.
    """

    goal: Goal
    asked: AnswerGoal | None = None
    accepted: bool = False
    cancelled: bool = False
    to_cancel: bool = False
    over: bool = False
    waiting: list[AnswerResult] = field(default_factory=list)

    @property
    def known(self) -> bool:
        """Whether the client knows that its goal is accepted."""
        return self.asked is None

    def admit(self, stamp: int) -> None:
        """Tell the client since when its goal is accepted, if it does not know."""
        asked, self.asked = self.asked, None
        if asked:
            self.goal.stamp = stamp
            asked(stamp)

    def reject(self) -> None:
        """Tell the client that its goal is not accepted, if it does not know better."""
        asked, self.asked = self.asked, None
        if asked:
            asked(None)

    def wait(self, answer: AnswerResult) -> bool:
        """Let a request wait for the result; False if too many do."""
        room = len(self.waiting) < MOST_UNANSWERED
        if room:
            self.waiting.append(answer)
        return room

    def end(self, status: int, result: object | None) -> None:
        """Answer all who wait for the result."""
        waiting, self.waiting = self.waiting, []
        for answer in waiting:
            answer(status, result)
