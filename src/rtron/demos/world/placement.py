"""How a scene that was drawn one way lies in the world: as drawn, mirrored, or turned round."""

from dataclasses import dataclass, replace
from math import atan2, cos, sin
from random import Random

from rtron.demos.world.ground_truth import Place
from rtron.demos.world.scenes.scene import Block, Crossing, Disc, Obstacle, Pose, Scene, box

_DIGITS = 3


@dataclass(frozen=True, slots=True)
class Placement:
    """Flips a room of `size` along x, along y, or both."""

    size: tuple[float, float]
    flip_x: bool
    flip_y: bool

    def place(self, place: Place) -> Place:
        """Return where a place of the drawing lies, to the millimetre."""
        x, y = place
        width, height = self.size
        flipped = (width - x if self.flip_x else x, height - y if self.flip_y else y)
        return round(flipped[0], _DIGITS), round(flipped[1], _DIGITS)

    def places(self, places: tuple[Place, ...]) -> tuple[Place, ...]:
        """Return where places of the drawing lie."""
        return tuple(map(self.place, places))

    def pose(self, pose: Pose) -> Pose:
        """Return how a pose of the drawing lies."""
        x = -cos(pose[2]) if self.flip_x else cos(pose[2])
        y = -sin(pose[2]) if self.flip_y else sin(pose[2])
        return (
            *self.place((pose[0], pose[1])),
            atan2(y + 0.0, x),
        )  # no -0.0, which is -180 degrees

    def obstacle(self, obstacle: Obstacle) -> Obstacle:
        """Return how an obstacle of the drawing lies."""
        if isinstance(obstacle, Disc):
            return Disc(self.place(obstacle.center), round(obstacle.radius, _DIGITS))
        return Block(self.places(obstacle.polygon))

    def crossing(self, crossing: Crossing) -> Crossing:
        """Return how a pedestrian's walk of the drawing lies."""
        door, stand = self.place(crossing.door), self.place(crossing.stand)
        return replace(crossing, door=door, stand=stand)


def placed(drawn: Scene, chance: Random) -> Scene:
    """Return a drawn scene as it lies in the world, with the walls around it."""
    laid = Placement(drawn.size, chance.choice((True, False)), chance.choice((True, False)))
    return replace(
        drawn,
        walls=box(*drawn.size),
        obstacles=tuple(map(laid.obstacle, drawn.obstacles)),
        start=laid.pose(drawn.start),
        goal=laid.place(drawn.goal),
        route=laid.places(drawn.route),
        area=laid.places(drawn.area) if drawn.area else None,
        bad_goal=laid.place(drawn.bad_goal) if drawn.bad_goal else None,
        light=laid.place(drawn.light) if drawn.light else None,
        crossings=tuple(map(laid.crossing, drawn.crossings)),
    )
