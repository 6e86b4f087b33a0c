"""The scene's things as shapely's shapes, for distances."""

from shapely import LineString, MultiLineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from rtron.demos.world.scenes.scene import Obstacle, RoundObstacle, Scene


def obstacle_shape(obstacle: Obstacle) -> BaseGeometry:
    """Return the shape of an obstacle."""
    if isinstance(obstacle, RoundObstacle):
        return Point(obstacle.center).buffer(obstacle.radius, quad_segs=32)
    return Polygon(obstacle.polygon)


def solid_area(scene: Scene) -> BaseGeometry:
    """Return all that the robot must not touch and that stays where it is."""
    walls = MultiLineString([((x1, y1), (x2, y2)) for x1, y1, x2, y2 in scene.walls])
    return unary_union([walls, *map(obstacle_shape, scene.obstacles)])


def route(scene: Scene) -> LineString:
    """Return the right way from the start to the goal."""
    return LineString(scene.route)
