"""The static map of a scene: walls and obstacles, not what moves."""

import json
from dataclasses import dataclass
from math import dist, inf
from typing import Any

from .geometry import Point, distance_to_polygon, distance_to_segment

Segment = tuple[Point, Point]


class BrokenMapError(Exception):
    """A text that is no map."""


@dataclass(frozen=True)
class StaticMap:
    """Walls as segments, round and cornered obstacles, and a rectangle around all (metres)."""

    low: Point
    high: Point
    walls: tuple[Segment, ...]
    circles: tuple[tuple[Point, float], ...]
    polygons: tuple[tuple[Point, ...], ...]

    def clearance(self, point: Point) -> float:
        """Return the distance to the nearest wall or obstacle, 0 inside of one."""
        return min(
            min((distance_to_segment(point, a, b) for a, b in self.walls), default=inf),
            min((max(0.0, dist(point, c) - r) for c, r in self.circles), default=inf),
            min((distance_to_polygon(point, corners) for corners in self.polygons), default=inf),
        )


def read_map(text: str) -> StaticMap:
    """Return the static map in a scene's JSON; BrokenMapError if there is none in it."""
    try:
        return _static_map(json.loads(text))
    except (ValueError, KeyError, TypeError, IndexError) as error:
        raise BrokenMapError(f"no map of a scene: {error!r}") from error


def _static_map(scene: dict[str, Any]) -> StaticMap:
    walls = tuple(((float(a), float(b)), (float(c), float(d))) for a, b, c, d in scene["walls"])
    obstacles = scene["obstacles"]
    corners = [point for wall in walls for point in wall] + [(0.0, 0.0), _point(scene["size"])]
    return StaticMap(
        low=(min(x for x, _ in corners), min(y for _, y in corners)),
        high=(max(x for x, _ in corners), max(y for _, y in corners)),
        walls=walls,
        circles=tuple(
            (_point(o["center"]), float(o["radius"])) for o in obstacles if "radius" in o
        ),
        polygons=tuple(
            tuple(_point(corner) for corner in o["polygon"]) for o in obstacles if "polygon" in o
        ),
    )


def _point(value: list[float]) -> Point:
    x, y = value
    return float(x), float(y)
