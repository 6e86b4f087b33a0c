"""How a scene that was drawn one way lies in the world: as drawn, mirrored, or turned round."""

from dataclasses import dataclass, replace
from math import atan2, cos, sin
from random import Random

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.scenes.scene import (
    Crossing,
    Obstacle,
    PolygonObstacle,
    Pose,
    RoundObstacle,
    Scene,
    room_walls,
)

_DIGITS = 3


@dataclass(frozen=True, slots=True)
class Flip:
    """Flips a room of `size` along x, along y, or both."""

    size: tuple[float, float]
    flip_x: bool
    flip_y: bool

    def position(self, point: Position) -> Position:
        """Return where a place of the drawing lies, to the millimetre."""
        x, y = point
        width, height = self.size
        flipped = (width - x if self.flip_x else x, height - y if self.flip_y else y)
        return round(flipped[0], _DIGITS), round(flipped[1], _DIGITS)

    def positions(self, points: tuple[Position, ...]) -> tuple[Position, ...]:
        """Return where places of the drawing lie."""
        return tuple(map(self.position, points))

    def pose(self, pose: Pose) -> Pose:
        """Return how a pose of the drawing lies."""
        x = -cos(pose[2]) if self.flip_x else cos(pose[2])
        y = -sin(pose[2]) if self.flip_y else sin(pose[2])
        return (
            *self.position((pose[0], pose[1])),
            atan2(y + 0.0, x),
        )  # no -0.0, which is -180 degrees

    def obstacle(self, obstacle: Obstacle) -> Obstacle:
        """Return how an obstacle of the drawing lies."""
        if isinstance(obstacle, RoundObstacle):
            return RoundObstacle(self.position(obstacle.center), round(obstacle.radius, _DIGITS))
        return PolygonObstacle(self.positions(obstacle.polygon))

    def crossing(self, crossing: Crossing) -> Crossing:
        """Return how a pedestrian's walk of the drawing lies."""
        start, stand = self.position(crossing.start), self.position(crossing.stand)
        return replace(crossing, start=start, stand=stand)


def place_scene(drawn: Scene, chance: Random) -> Scene:
    """Return a drawn scene as it lies in the world, with the walls around it."""
    laid = Flip(drawn.size, chance.choice((True, False)), chance.choice((True, False)))
    return replace(
        drawn,
        walls=room_walls(*drawn.size),
        obstacles=tuple(map(laid.obstacle, drawn.obstacles)),
        start=laid.pose(drawn.start),
        goal=laid.position(drawn.goal),
        route=laid.positions(drawn.route),
        area=laid.positions(drawn.area) if drawn.area else None,
        bad_goal=laid.position(drawn.bad_goal) if drawn.bad_goal else None,
        light=laid.position(drawn.light) if drawn.light else None,
        crossings=tuple(map(laid.crossing, drawn.crossings)),
    )
