"""From goal, odometry, maximal velocity and detections to the velocity commands of /move_base."""

from collections.abc import Iterable
from math import dist, isfinite

from .geometry import Point, Pose, Velocity
from .obstacle_watch import ObstacleWatch
from .occupancy_grid import Grid
from .path_planner import plan
from .pure_pursuit import Tracker, reachable
from .recognition import Detection
from .speed_limit import CRUISE

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
