"""GR's scene: a straight way through a corridor."""

from random import Random

from rtron.demos.world.scenes.geometry import mission_length, rectangle
from rtron.demos.world.scenes.scene import PolygonObstacle, Scene


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
