"""The operator's goal, and whether the robot has reached it."""

from collections.abc import Sequence
from math import dist

from .pure_pursuit import REACHED

_TOLERANCE = 0.07


class GoalMonitor:
    """Reports once that the robot is at its goal."""

    def __init__(self) -> None:
        self._goal: Sequence[float] | None = None

    def begin(self, goal: Sequence[float]) -> None:
        """Take a new goal (metres)."""
        self._goal = goal

    def has_arrived(self, pose: Sequence[float]) -> bool:
        """Return whether this pose is the first at the goal."""
        goal = self._goal
        if goal is None or dist(goal, pose[:2]) > REACHED + _TOLERANCE:
            return False
        self._goal = None
        return True
