"""A pedestrian: steps out of a door when the robot comes, stands in its way, and goes back."""

from dataclasses import dataclass
from enum import Enum
from math import dist

from shapely import LineString, Point

from rtron.demos.world.ground_truth import Place
from rtron.demos.world.scenes.scene import Crossing

_NEAREST, _BEYOND = 0.6, 0.25
"""How far from the nominal place a pedestrian may stand: this share of the walk, and m."""


class Phase(Enum):
    """Where in the walk a pedestrian is."""

    BEFORE = "before"
    COMING = "coming"
    STANDING = "standing"
    LEAVING = "leaving"
    GONE = "gone"


@dataclass(slots=True)
class Pedestrian:
    """A walk that happens once a run."""

    crossing: Crossing
    route: LineString
    goal: Place
    phase: Phase = Phase.BEFORE
    walked: float = 0.0
    """m from the door."""
    until: float = 0.0
    """m from the door to where the pedestrian will stand."""
    stood: float = 0.0
    """s."""

    @property
    def place(self) -> Place | None:
        """Where the pedestrian is; None before and after the walk."""
        if self.phase in {Phase.BEFORE, Phase.GONE}:
            return None
        share = self.walked / self._length
        (ax, ay), (bx, by) = self.crossing.door, self.crossing.stand
        return ax + share * (bx - ax), ay + share * (by - ay)

    def step(self, seconds: float, robot: Place) -> None:
        """Live on for some seconds, with the robot at a place."""
        if self.phase is Phase.BEFORE:
            self._look(robot)
        elif self.phase is Phase.COMING:
            self._walk(seconds)
        elif self.phase is Phase.STANDING:
            self._stand(seconds)
        elif self.phase is Phase.LEAVING:
            self._walk(-seconds)

    @property
    def _length(self) -> float:
        return dist(self.crossing.door, self.crossing.stand)

    def _look(self, robot: Place) -> None:
        here = self.route.project(Point(robot))
        there = self.route.project(Point(self.crossing.stand))
        if there - self.crossing.ahead <= here < there:
            self.until = self._meeting(robot)
            self.phase = Phase.COMING

    def _walk(self, seconds: float) -> None:
        self.walked += self.crossing.pace * seconds
        if self.walked >= self.until:
            self.walked, self.phase = self.until, Phase.STANDING
        elif self.walked <= 0.0:
            self.phase = Phase.GONE

    def _stand(self, seconds: float) -> None:
        self.stood += seconds
        if self.stood >= self.crossing.stays:
            self.phase = Phase.LEAVING

    def _meeting(self, robot: Place) -> float:
        """Return how far it is to where the walk crosses the robot's line to its goal, m."""
        (dx, dy), (sx, sy) = self.crossing.door, self.crossing.stand
        gx, gy = self.goal[0] - robot[0], self.goal[1] - robot[1]
        along = gx * (sy - dy) - gy * (sx - dx)
        away = gy * (dx - robot[0]) - gx * (dy - robot[1])
        wanted = self._length * (away / along if along else 1.0)
        return max(_NEAREST * self._length, min(self._length + _BEYOND, wanted))
