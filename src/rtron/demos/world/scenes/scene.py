"""The scene of a run: what stands where, who comes by, and which way is right."""

from dataclasses import dataclass

from rtron.demos.world.ground_truth import Position

OVERSPEED = 0.26
"""Above this the robot is too fast, m/s: the cruise of a TurtleBot3 burger, and some spare."""

Pose = tuple[float, float, float]
Segment = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class RoundObstacle:
    """A round obstacle, m."""

    center: Position
    radius: float


@dataclass(frozen=True, slots=True)
class PolygonObstacle:
    """An obstacle with corners, m; convex."""

    polygon: tuple[Position, ...]


Obstacle = RoundObstacle | PolygonObstacle


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """A pedestrian's walk: out of a door, into the robot's way, and back.

    The walk begins when the robot is `trigger_distance` m of its path before the point `stand`. The
    pedestrian walks at `pace` m/s and stands still for `pause` s.
    """

    start: Position
    stand: Position
    trigger_distance: float
    pause: float
    pace: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A world of size (w, h) m with its origin in a corner, and what a run in it is about.

    The light is red until `green_after` s after the start. `area` is the polygon without network.
    Where a person drives (`is_teleoperated`) the mission gets no goal.
    """

    case: str
    seed: int
    size: tuple[float, float]
    walls: tuple[Segment, ...]
    obstacles: tuple[Obstacle, ...]
    start: Pose
    goal: Position
    route: tuple[Position, ...]
    area: tuple[Position, ...] | None = None
    bad_goal: Position | None = None
    light: Position | None = None
    green_after: float = 0.0
    crossings: tuple[Crossing, ...] = ()
    is_teleoperated: bool = False


def room_walls(width: float, height: float) -> tuple[Segment, ...]:
    """Return the four walls around a room, m."""
    corners = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    return tuple(a + b for a, b in zip(corners, corners[1:] + corners[:1], strict=True))
