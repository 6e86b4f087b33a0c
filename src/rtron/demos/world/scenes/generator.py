"""The scene of a case and a seed: the same two make the same scene, on every machine.

The agent's is another one of the kind, in which a person drives.
"""

from collections.abc import Callable
from dataclasses import replace
from math import atan2, cos, sin
from random import Random

from shapely import LineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.robot_base import RADIUS
from rtron.demos.world.scenes.geometry import (
    CLEARANCE,
    clear_corridor,
    convex_hull,
    mission_length,
    place_obstacles,
    polygon_around,
    rectangle,
)
from rtron.demos.world.scenes.scene import (
    Crossing,
    Obstacle,
    PolygonObstacle,
    RoundObstacle,
    Scene,
    room_walls,
)

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
