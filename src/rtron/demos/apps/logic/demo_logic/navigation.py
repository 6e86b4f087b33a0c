"""From goal, odometry, maximal velocity and detections to the velocity commands of /move_base."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import atan2, cos, dist, isfinite, pi, sin, sqrt

from .geometry import Point, Pose, Velocity, clamp, wrap_angle
from .path_planning import Grid, plan
from .perception import CRUISE, Detection, ObstacleWatch

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
    """Pure pursuit (Coulter 1992): steers on a circle to a point some way ahead on the route."""

    route: Sequence[Point]
    passed: int = 0

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


_STILL: Velocity = (0.0, 0.0)
_LAST_ZEROS = 5
_CARRIED = 0.5


class Navigator:
    """The state of /move_base; `command` is called ten times a simulated second."""

    def __init__(self) -> None:
        self.pose: Pose | None = None
        self.velocity: Velocity = _STILL
        self.max_velocity = CRUISE
        self._watch = ObstacleWatch()
        self._tracker: Tracker | None = None
        self._zeros = 0

    def set_odometry(self, pose: Pose, velocity: Velocity) -> None:
        """Take the odometry. A robot that was carried elsewhere forgets its goal and its limit."""
        if self.pose is not None and dist(self.pose[:2], pose[:2]) > _CARRIED:
            self._tracker, self.max_velocity = None, CRUISE
        self.pose, self.velocity = pose, velocity

    def set_max_velocity(self, max_velocity: float) -> None:
        """Take a maximal velocity, m/s; what is no velocity is left out."""
        if isfinite(max_velocity) and max_velocity >= 0:
            self.max_velocity = max_velocity

    def set_detections(self, detections: Iterable[Detection]) -> None:
        """Take the detections in an image."""
        self._watch.update(detections)

    def set_goal(self, goal: Point, grid: Grid) -> bool:
        """Plan a route to a goal and drop the last one; return whether there is a path.

        Without odometry, or a path, the robot keeps to the goal that it has.
        """
        route = plan(grid, self.pose[:2], goal) if self.pose and all(map(isfinite, goal)) else None
        if route:
            self._tracker, self._zeros = Tracker(route), _LAST_ZEROS
        return route is not None

    def command(self) -> Velocity | None:
        """Return the next command, None while there is none."""
        tracker, pose = self._tracker, self.pose  # other threads replace them
        if tracker is None or pose is None:
            return self._last_zero()
        velocity = tracker.velocity(pose, self.velocity, self.max_velocity)
        if velocity is not None:
            return reachable(_STILL, self.velocity) if self._watch.stopped else velocity
        if self._tracker is tracker:
            self._tracker = None
        return self._last_zero()

    def _last_zero(self) -> Velocity | None:
        if not self._zeros:
            return None
        self._zeros -= 1
        return _STILL


_TOLERANCE = 0.07


class GoalMonitor:
    """Reports once that the robot is at the operator's goal."""

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
