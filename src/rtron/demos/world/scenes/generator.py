"""The scene of a case and a seed: the same two make the same scene, on every machine."""

from collections.abc import Callable
from dataclasses import replace
from math import atan2, cos, sin
from random import Random

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.scenes.geometry import mission_length, rectangle
from rtron.demos.world.scenes.network_outage import agent_outage, network_outage
from rtron.demos.world.scenes.scene import (
    Obstacle,
    PolygonObstacle,
    RoundObstacle,
    Scene,
    room_walls,
)
from rtron.demos.world.scenes.street import street

_DIGITS = 3


def place_scene(drawn: Scene, chance: Random) -> Scene:
    """Return a drawn scene as it lies in the world, by chance flipped, with walls around it."""
    flips_x, flips_y = chance.choice((True, False)), chance.choice((True, False))
    width, height = drawn.size

    def placed(point: Position) -> Position:
        """Return where a place of the drawing lies, to the millimetre."""
        x, y = point
        flipped = width - x if flips_x else x, height - y if flips_y else y
        return round(flipped[0], _DIGITS), round(flipped[1], _DIGITS)

    def obstacle(drawn: Obstacle) -> Obstacle:
        if isinstance(drawn, RoundObstacle):
            return RoundObstacle(placed(drawn.center), round(drawn.radius, _DIGITS))
        return PolygonObstacle(tuple(map(placed, drawn.polygon)))

    x, y, heading = drawn.start
    ahead = -cos(heading) if flips_x else cos(heading)
    aside = -sin(heading) if flips_y else sin(heading)
    return replace(
        drawn,
        walls=room_walls(*drawn.size),
        obstacles=tuple(map(obstacle, drawn.obstacles)),
        start=(*placed((x, y)), atan2(aside + 0.0, ahead)),  # no -0.0, which is -180 degrees
        goal=placed(drawn.goal),
        route=tuple(map(placed, drawn.route)),
        area=tuple(map(placed, drawn.area)) if drawn.area else None,
        bad_goal=placed(drawn.bad_goal) if drawn.bad_goal else None,
        light=placed(drawn.light) if drawn.light else None,
        crossings=tuple(
            replace(each, start=placed(each.start), stand=placed(each.stand))
            for each in drawn.crossings
        ),
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
