"""MSR's scene: a room with an area that has no network, and a goal inside it.

The agent's is another one of the kind, in which a person drives.
"""

from dataclasses import replace
from random import Random

from shapely import LineString, Polygon
from shapely.ops import unary_union

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.robot_base import RADIUS
from rtron.demos.world.scenes.geometry import (
    CLEARANCE,
    clear_corridor,
    mission_length,
    place_obstacles,
    polygon_around,
)
from rtron.demos.world.scenes.scene import RoundObstacle, Scene

_CORNERS = 7
_PATH_CLEARANCE = 0.8
"""Between the area and the straight way, m: a way around the obstacle on either side is right."""
_FROM_AREA = 0.35
_OFF = 0.1
"""The obstacle's middle is so far off the straight way, m, so that one way around is shorter."""


def network_outage(seed: int, chance: Random) -> Scene:
    """Draw a room whose way leads around an obstacle, and past the area."""
    far = mission_length(chance)
    start = (chance.uniform(0.5, 0.7), chance.uniform(0.9, 1.05))
    goal = (start[0] + far, chance.uniform(0.9, 1.05))
    middle = _obstacle(chance, start, goal)
    path = (start, _around(middle), goal)
    center, area = _area(chance, start, goal)
    top = max(y for _, y in area)
    size = (round(goal[0] + chance.uniform(0.5, 0.8), 2), round(top + chance.uniform(0.3, 0.6), 2))
    reach = LineString([start, center]).buffer(RADIUS + CLEARANCE)
    free = unary_union([clear_corridor(LineString(path)), Polygon(area).buffer(_FROM_AREA), reach])
    free = unary_union([free, LineString([start, goal]).buffer(_PATH_CLEARANCE)])
    return Scene(
        case="msr",
        seed=seed,
        size=size,
        walls=(),
        obstacles=(middle, *place_obstacles(chance, size, free, chance.randint(1, 3))),
        start=(*start, chance.uniform(-0.1, 0.1)),
        goal=goal,
        route=path,
        area=area,
        bad_goal=(center[0] + chance.uniform(-0.08, 0.08), center[1] + chance.uniform(-0.05, 0.05)),
    )


def agent_outage(seed: int, chance: Random) -> Scene:
    """Draw such a room for a person who drives the robot."""
    return replace(network_outage(seed, chance), case="agent", is_teleoperated=True)


def _obstacle(chance: Random, start: Position, goal: Position) -> RoundObstacle:
    share = chance.uniform(0.45, 0.6)
    x, y = (a + share * (b - a) for a, b in zip(start, goal, strict=True))
    return RoundObstacle((x, y + _OFF), chance.uniform(0.12, 0.2))


def _around(obstacle: RoundObstacle) -> Position:
    x, y = obstacle.center
    return x, y - obstacle.radius - RADIUS - CLEARANCE - 0.02


def _area(chance: Random, start: Position, goal: Position) -> tuple[Position, tuple[Position, ...]]:
    """Return the area's middle and its corners; the right way passes below it."""
    half = (chance.uniform(0.65, 0.9), chance.uniform(0.5, 0.6))
    x = start[0] + chance.uniform(0.5, 0.65) * (goal[0] - start[0])
    center = (x, max(start[1], goal[1]) + _PATH_CLEARANCE + half[1])
    shares = [chance.uniform(0.87, 1.0) for _ in range(_CORNERS)]
    radii = [(half[0] * share, half[1] * share) for share in shares]
    return center, polygon_around(center, radii, chance.uniform(0.0, 1.0))
