"""Distances in the plane, metres and radians."""

from collections.abc import Sequence
from math import atan2, cos, dist, inf, pi, sin

Point = tuple[float, float]
Pose = tuple[float, float, float]
"""x, y, and the heading counted from the x axis to the left."""
Velocity = tuple[float, float]
"""Forwards (m/s) and to the left (rad/s)."""


def wrap_angle(angle: float) -> float:
    """Return the same angle in (-pi, pi]."""
    return pi - (pi - angle) % (2 * pi)


def quaternion(heading: float) -> tuple[float, float]:
    """Return z and w of the rotation to a heading; x and y are 0."""
    return sin(heading / 2), cos(heading / 2)


def heading(z: float, w: float) -> float:
    """Return the heading of a rotation about the z axis."""
    return wrap_angle(2 * atan2(z, w))


def clamp(value: float, bound: float) -> float:
    """Return the value, limited to between -bound and bound."""
    return max(-bound, min(bound, value))


def distance_to_segment(point: Point, start: Point, end: Point) -> float:
    """Return the distance of a point from a segment."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = dx * dx + dy * dy
    along = (point[0] - start[0]) * dx + (point[1] - start[1]) * dy
    part = max(0.0, min(1.0, along / length)) if length else 0.0
    return dist(point, (start[0] + part * dx, start[1] + part * dy))


def distance_to_polygon(point: Point, corners: Sequence[Point]) -> float:
    """Return the distance of a point from a polygon, 0 inside of it."""
    if inside(point, corners):
        return 0.0
    return min((distance_to_segment(point, a, b) for a, b in _edges(corners)), default=inf)


def inside(point: Point, corners: Sequence[Point]) -> bool:
    """Return whether a point is inside of a polygon: a ray to the right crosses odd many edges."""
    x, y = point
    within = False
    for (ax, ay), (bx, by) in _edges(corners):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            within = not within
    return within


def _edges(corners: Sequence[Point]) -> list[tuple[Point, Point]]:
    return list(zip(corners, [*corners[1:], *corners[:1]], strict=True))
