"""Pure pursuit of a route (Coulter 1992): steer on a circle to a point some way ahead on it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import atan2, cos, dist, pi, sin, sqrt

from .geometry import Point, Pose, Velocity, clamp, wrap_angle

REACHED = 0.1
"""The goal is reached within this distance, metres."""
PERIOD = 0.1
"""Between two commands, simulated seconds."""
MAX_TURN = 1.0
"""rad/s."""
_AHEAD, _AHEAD_TIME = 0.25, 0.5
_BRAKING = 0.1
_CREEP = 0.06
_SLOWEST_PART = 0.8
_ACCELERATION, _TURN_ACCELERATION = 1.0, 0.7
_WINDOW = 40


@dataclass
class Tracker:
    """A route and how far along it the robot has come."""

    route: Sequence[Point]
    passed: int = field(default=0)

    def velocity(self, pose: Pose, now: Velocity, max_velocity: float) -> Velocity | None:
        """Return the next command, None at the goal.

        It differs from the velocity `now` by no more than the accelerations allow in a period.
        """
        left = dist(pose[:2], self.route[-1])
        if left <= REACHED:
            return None
        target = self._target(pose[:2], _AHEAD + _AHEAD_TIME * now[0])
        return reachable(_towards(pose, target, _slowing(left, max_velocity)), now)

    def _target(self, position: Point, ahead: float) -> Point:
        """Return the first point of the rest of the route that is `ahead` metres away."""
        near = range(self.passed, min(len(self.route), self.passed + _WINDOW))
        self.passed = min(near, key=lambda n: dist(self.route[n], position))
        rest = (self.route[n] for n in range(self.passed, len(self.route)))
        return next((point for point in rest if dist(point, position) >= ahead), self.route[-1])


def reachable(target: Velocity, now: Velocity) -> Velocity:
    """Return the velocity nearest to the target that a period's acceleration can reach."""
    return (
        now[0] + clamp(target[0] - now[0], _ACCELERATION * PERIOD),
        now[1] + clamp(target[1] - now[1], _TURN_ACCELERATION * PERIOD),
    )


def _slowing(left: float, max_velocity: float) -> float:
    """Return the velocity from which the robot stops at the goal, `left` metres away."""
    return min(max_velocity, max(_CREEP, sqrt(2 * _BRAKING * left)))


def _towards(pose: Pose, target: Point, velocity: float) -> Velocity:
    aside = wrap_angle(atan2(target[1] - pose[1], target[0] - pose[0]) - pose[2])
    forwards = velocity * max(_SLOWEST_PART, cos(aside))
    if abs(aside) > pi / 2:
        return forwards, MAX_TURN if aside > 0 else -MAX_TURN
    curvature = 2 * sin(aside) / dist(pose[:2], target)
    return forwards, clamp(forwards * curvature, MAX_TURN)
