"""What the scenes are drawn with: chance, rectangles, and things scattered where there is room."""

from collections.abc import Sequence
from math import ceil, cos, pi, sin
from random import Random
from typing import Any

import numpy as np
import shapely
from shapely import MultiLineString, MultiPoint, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.robot_base import RADIUS
from rtron.demos.world.scenes.scene import Obstacle, PolygonObstacle, RoundObstacle, Scene


def obstacle_shape(obstacle: Obstacle) -> BaseGeometry:
    """Return the shape of an obstacle."""
    if isinstance(obstacle, RoundObstacle):
        return Point(obstacle.center).buffer(obstacle.radius, quad_segs=32)
    return Polygon(obstacle.polygon)


def solid_area(scene: Scene) -> BaseGeometry:
    """Return all that the robot must not touch and that stays where it is."""
    walls = MultiLineString([((x1, y1), (x2, y2)) for x1, y1, x2, y2 in scene.walls])
    return unary_union([walls, *map(obstacle_shape, scene.obstacles)])


_MAP_CELL = 0.1
"""Side of a cell of the map, m."""


def clearance_map(scene: Scene) -> dict[str, Any]:
    """Return the static map: how far each cell's middle is from what the robot must not touch, m.

    The cells are row by row, from the scene's origin on.
    """
    columns, rows = (ceil(side / _MAP_CELL) for side in scene.size)
    xs, ys = ((np.arange(count) + 0.5) * _MAP_CELL for count in (columns, rows))
    clearances = shapely.distance(solid_area(scene), shapely.points(*np.meshgrid(xs, ys)))
    return {"cell": _MAP_CELL, "columns": columns, "clearances": clearances.ravel().tolist()}


CLEARANCE = 0.22
"""Free space on each side of the robot on the right way, m."""
WIDE = 0.5
"""Between two things there is nothing or this much, so that no gap is a question of luck, m."""
_TRIES = 40


def mission_length(chance: Random) -> float:
    """Return how long a mission is, m."""
    return round(chance.uniform(3.6, 4.9), 2)


def rectangle(x: float, y: float, width: float, height: float) -> PolygonObstacle:
    """Return a block whose lowest corner is at x, y (m)."""
    return PolygonObstacle(((x, y), (x + width, y), (x + width, y + height), (x, y + height)))


def polygon_around(
    center: Position, radii: Sequence[Position], turned: float
) -> tuple[Position, ...]:
    """Return a polygon around a place, whose corners have these radii along x and y (m)."""
    angles = [turned + 2 * pi * k / len(radii) for k in range(len(radii))]
    return tuple(
        (center[0] + rx * cos(angle), center[1] + ry * sin(angle))
        for (rx, ry), angle in zip(radii, angles, strict=True)
    )


def clear_corridor(path: BaseGeometry) -> BaseGeometry:
    """Return the space that a robot needs on a way, with what is to be free on its sides."""
    return path.buffer(RADIUS + CLEARANCE)


def place_obstacles(
    chance: Random, size: tuple[float, float], free_area: BaseGeometry, count: int
) -> tuple[Obstacle, ...]:
    """Return up to `count` obstacles in a room, away from what is kept free and each other."""
    found: list[Obstacle] = []
    taken: BaseGeometry = Point()
    for _ in range(_TRIES):
        candidate = _random_obstacle(chance, size)
        area = obstacle_shape(candidate)
        if area.intersects(free_area) or area.distance(taken) < WIDE:
            continue
        found.append(candidate)
        taken = unary_union([taken, area])
        if len(found) == count:
            break
    return tuple(found)


def _random_obstacle(chance: Random, size: tuple[float, float]) -> Obstacle:
    """Return a thing that stands free, or a shelf at the upper wall."""
    if chance.choice((True, False)):
        radius = chance.uniform(0.1, 0.22)
        x, y = (chance.uniform(WIDE + radius, side - WIDE - radius) for side in size)
        return RoundObstacle((x, y), radius)
    width, depth = chance.uniform(0.3, 0.8), chance.uniform(0.2, 0.4)
    return rectangle(chance.uniform(0.0, size[0] - width), size[1] - depth, width, depth)


def convex_hull(*positions: Position) -> BaseGeometry:
    """Return the smallest convex shape with these places."""
    return MultiPoint(positions).convex_hull
