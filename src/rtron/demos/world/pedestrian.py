"""A pedestrian: steps out of a door when the robot comes, stands in its way, and goes back."""

from dataclasses import dataclass
from enum import Enum
from math import dist

from shapely import LineString, Point

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.scenes.scene import Crossing

_NEAREST, _BEYOND = 0.6, 0.25
"""How far from the nominal place a pedestrian may stand: this share of the walk, and m."""


class WalkPhase(Enum):
    """Where in the walk a pedestrian is."""

    HIDDEN = "before"
    APPROACHING = "coming"
    PAUSING = "standing"
    RETURNING = "leaving"
    DONE = "gone"


@dataclass(slots=True)
class Pedestrian:
    """A walk that happens once a run."""

    crossing: Crossing
    route: LineString
    goal: Position
    phase: WalkPhase = WalkPhase.HIDDEN
    walked: float = 0.0
    """m from the door."""
    target_distance: float = 0.0
    """m from the door to where the pedestrian will stand."""
    paused: float = 0.0
    """s."""

    @property
    def position(self) -> Position | None:
        """Where the pedestrian is; None before and after the walk."""
        if self.phase in {WalkPhase.HIDDEN, WalkPhase.DONE}:
            return None
        share = self.walked / self._length
        (ax, ay), (bx, by) = self.crossing.start, self.crossing.stand
        return ax + share * (bx - ax), ay + share * (by - ay)

    def step(self, seconds: float, robot: Position) -> None:
        """Live on for some seconds, with the robot at a place."""
        if self.phase is WalkPhase.HIDDEN:
            self._check_start(robot)
        elif self.phase is WalkPhase.APPROACHING:
            self._walk(seconds)
        elif self.phase is WalkPhase.PAUSING:
            self._pause(seconds)
        elif self.phase is WalkPhase.RETURNING:
            self._walk(-seconds)

    @property
    def _length(self) -> float:
        return dist(self.crossing.start, self.crossing.stand)

    def _check_start(self, robot: Position) -> None:
        robot_progress = self.route.project(Point(robot))
        stand_progress = self.route.project(Point(self.crossing.stand))
        if stand_progress - self.crossing.trigger_distance <= robot_progress < stand_progress:
            self.target_distance = self._crossing_distance(robot)
            self.phase = WalkPhase.APPROACHING

    def _walk(self, seconds: float) -> None:
        self.walked += self.crossing.pace * seconds
        if self.walked >= self.target_distance:
            self.walked, self.phase = self.target_distance, WalkPhase.PAUSING
        elif self.walked <= 0.0:
            self.phase = WalkPhase.DONE

    def _pause(self, seconds: float) -> None:
        self.paused += seconds
        if self.paused >= self.crossing.pause:
            self.phase = WalkPhase.RETURNING

    def _crossing_distance(self, robot: Position) -> float:
        """Return how far it is to where the walk crosses the robot's line to its goal, m."""
        (dx, dy), (sx, sy) = self.crossing.start, self.crossing.stand
        gx, gy = self.goal[0] - robot[0], self.goal[1] - robot[1]
        along = gx * (sy - dy) - gy * (sx - dx)
        away = gy * (dx - robot[0]) - gx * (dy - robot[1])
        distance = self._length * (away / along if along else 1.0)
        return max(_NEAREST * self._length, min(self._length + _BEYOND, distance))
