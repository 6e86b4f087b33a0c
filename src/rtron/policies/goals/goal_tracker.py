"""Which goal of an action a goal that was given another way has become: the one that appears next.

`move_base_simple/goal` has no goal id; its server gives itself a goal of its own instead.
"""

from collections.abc import Iterable


class GoalTracker:
    """Knows the goal that followed what was said last; sans-I/O."""

    def __init__(self) -> None:
        self._is_expecting = False
        self._known_goals: frozenset[bytes] = frozenset()
        self.flow = ""
        self.goal: bytes | None = None

    def expect_goal(self, flow: str) -> None:
        """Expect a goal: something of `flow` went out."""
        self._is_expecting, self.flow, self.goal = True, flow, None

    @property
    def is_expecting(self) -> bool:
        """Whether the goal has not appeared yet."""
        return self._is_expecting

    def stop_expecting(self) -> None:
        """Expect no goal any more: what was said has become none."""
        self._is_expecting = False

    def update_goals(self, ids: Iterable[bytes]) -> None:
        """Take the goals that there are; one that was not there before may be the expected one."""
        known = frozenset(ids)
        new = sorted(known - self._known_goals)
        self._known_goals = known
        if new:
            self.add_goal(new[-1])

    def add_goal(self, id: bytes) -> None:
        """Take a goal that is new."""
        if self._is_expecting:
            self._is_expecting, self.goal = False, id

    def finish_goal(self, id: bytes) -> bool:
        """Tell whether the goal that is over is what was said last; it may not have been seen."""
        if id not in self._known_goals:
            self.add_goal(id)
        ended = id == self.goal
        self.goal = None if ended else self.goal
        return ended
