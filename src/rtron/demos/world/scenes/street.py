"""RSR's scene: a traffic light and pedestrians who step out of doors into the robot's way."""

from random import Random

from shapely import LineString
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.scenes.geometry import (
    clear_corridor,
    convex_hull,
    mission_length,
    place_obstacles,
)
from rtron.demos.world.scenes.scene import Crossing, RoundObstacle, Scene

_BESIDE = 0.42
"""So far from the way the light stands, m."""
_POLE = 0.05
_BEHIND = 0.2
"""So far behind the wall a pedestrian's walk begins, m: the doors open for people only."""
_SPAN = 1.2
"""Two pedestrians are at least this far from each other, m."""
_TO_GOAL = 0.7
_FROM_WALL = (0.55, 0.7)
"""So far from the doors' wall the way is, m."""


def street(seed: int, chance: Random) -> Scene:
    """Draw a room with a straight way along a wall that has doors."""
    far = mission_length(chance)
    start = (chance.uniform(0.5, 0.7), chance.uniform(*_FROM_WALL))
    goal = (start[0] + far, chance.uniform(*_FROM_WALL))
    size = (round(goal[0] + chance.uniform(0.5, 0.8), 2), round(chance.uniform(2.2, 3.0), 2))
    light = _light(chance, start, goal)
    crossings = _crossings(chance, start, goal)
    free = _free_area(start, goal, light, crossings)
    pole = RoundObstacle(light, _POLE)
    return Scene(
        case="rsr",
        seed=seed,
        size=size,
        walls=(),
        obstacles=(pole, *place_obstacles(chance, size, free, chance.randint(2, 4))),
        start=(*start, chance.uniform(-0.1, 0.1)),
        goal=goal,
        route=(start, goal),
        light=light,
        green_after=round(chance.uniform(6.5, 10.0), 2),
        crossings=crossings,
    )


def _point_on_path(start: Position, goal: Position, x: float) -> Position:
    """Return the place on the way from the start to the goal that has this x."""
    share = (x - start[0]) / (goal[0] - start[0])
    return x, start[1] + share * (goal[1] - start[1])


def _light(chance: Random, start: Position, goal: Position) -> Position:
    x, y = _point_on_path(start, goal, start[0] + chance.uniform(1.4, 1.7))
    return x, y + _BESIDE


def _crossings(chance: Random, start: Position, goal: Position) -> tuple[Crossing, ...]:
    first = start[0] + chance.uniform(2.3, 2.7)
    xs = [first, first + _SPAN + chance.uniform(0.0, 0.3)][: chance.randint(1, 2)]
    return tuple(
        _crossing(chance, _point_on_path(start, goal, x)) for x in xs if x <= goal[0] - _TO_GOAL
    )


def _crossing(chance: Random, stand: Position) -> Crossing:
    return Crossing(
        start=(stand[0], -_BEHIND),
        stand=stand,
        trigger_distance=round(chance.uniform(1.2, 1.45), 3),
        pause=round(chance.uniform(3.5, 5.0), 2),
        pace=round(chance.uniform(1.5, 1.8), 2),
    )


def _free_area(
    start: Position, goal: Position, light: Position, crossings: tuple[Crossing, ...]
) -> BaseGeometry:
    """Return where nothing stands: the way, the walks, and before the light."""
    line_of_sight = convex_hull(start, (light[0], start[1]), light).buffer(0.1)
    walks = [LineString([c.start, c.stand]).buffer(0.4) for c in crossings]
    return unary_union([clear_corridor(LineString([start, goal])), line_of_sight, *walks])
