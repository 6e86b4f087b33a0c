"""From goal, odometry, maximal velocity and detections to the velocity commands of /move_base."""

from collections.abc import Iterable
from math import dist, isfinite

from .deciding import CRUISE
from .geometry import Point, Pose, Velocity
from .grid import Grid
from .recognition import Detection
from .route import plan
from .tracking import Tracker, reachable
from .watching import Watch

_STILL: Velocity = (0.0, 0.0)
_LAST_ZEROS = 5
_CARRIED = 0.5


class Navigator:
    """The state of /move_base; `command` is asked ten times a simulated second."""

    def __init__(self) -> None:
        self.pose: Pose | None = None
        self.velocity: Velocity = _STILL
        self.max_velocity = CRUISE
        self._watch = Watch()
        self._tracker: Tracker | None = None
        self._zeros = 0

    def moved(self, pose: Pose, velocity: Velocity) -> None:
        """Take the odometry. One that was carried elsewhere forgets its goal and its limit."""
        if self.pose is not None and dist(self.pose[:2], pose[:2]) > _CARRIED:
            self._tracker, self.max_velocity = None, CRUISE
        self.pose, self.velocity = pose, velocity

    def limit(self, max_velocity: float) -> None:
        """Take a maximal velocity, m/s; what is no velocity is left out."""
        if isfinite(max_velocity) and max_velocity >= 0:
            self.max_velocity = max_velocity

    def seen(self, detections: Iterable[Detection]) -> None:
        """Take what one image showed."""
        self._watch.seen(detections)

    def head_for(self, goal: Point, grid: Grid) -> bool:
        """Plan a route to a goal and drop the last one; tell whether there is a way.

        Without odometry, or a way, the robot keeps to the goal that it has.
        """
        route = plan(grid, self.pose[:2], goal) if self.pose and all(map(isfinite, goal)) else None
        if route:
            self._tracker, self._zeros = Tracker(route), _LAST_ZEROS
        return route is not None

    def command(self) -> Velocity | None:
        """Return the next command, None while there is nothing to say."""
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
