"""The scene of a case and a seed: the same two make the same scene, on every machine."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import atan2, cos, sin
from random import Random

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.scenes.geometry import mission_length, rectangle
from rtron.demos.world.scenes.network_outage import agent_outage, network_outage
from rtron.demos.world.scenes.scene import (
    Crossing,
    Obstacle,
    PolygonObstacle,
    Pose,
    RoundObstacle,
    Scene,
    room_walls,
)
from rtron.demos.world.scenes.street import street

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


def corridor(seed: int, chance: Random) -> Scene:
    """Draw a corridor 1.0 to 1.3 m wide, with pillars at its walls."""
    far, width = mission_length(chance), round(chance.uniform(1.0, 1.3), 2)
    begin, end = chance.uniform(0.4, 0.6), chance.uniform(0.4, 0.8)
    start = (begin, width / 2 + chance.uniform(-0.04, 0.04))
    goal = (begin + far, width / 2 + chance.uniform(-0.04, 0.04))
    size = (round(begin + far + end, 2), width)
    return Scene(
        case="gr",
        seed=seed,
        size=size,
        walls=(),
        obstacles=tuple(_pillar(chance, size) for _ in range(chance.randint(0, 3))),
        start=(*start, 0.0),
        goal=goal,
        route=(start, goal),
    )


def _pillar(chance: Random, size: tuple[float, float]) -> PolygonObstacle:
    width, depth = chance.uniform(0.15, 0.35), chance.uniform(0.06, 0.11)
    x = chance.uniform(0.0, size[0] - width)
    y = chance.choice((0.0, size[1] - depth))
    return rectangle(x, y, width, depth)


_GENERATORS: dict[str, Callable[[int, Random], Scene]] = {
    "gr": corridor,
    "rsr": street,
    "msr": network_outage,
    "agent": agent_outage,
}


def make_scene(case: str, seed: int) -> Scene:
    """Return the scene of a case (gr, rsr, msr or agent) and a seed; KeyError for another."""
    chance = Random(f"{case} {seed}")  # noqa: S311 - a world, no secret
    return place_scene(_GENERATORS[case](seed, chance), chance)
