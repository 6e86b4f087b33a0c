"""Places on the ground: the edges of areas, and motions from one frame into another."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rtron.vocabulary import Point, Transform

TOLERANCE = 1e-9
"""What lies as near to an edge (m) counts as inside: areas are mostly forbidden."""

XY = tuple[float, float]


@dataclass(frozen=True, slots=True)
class PolygonEdge:
    """An edge from (x, y) on: `dx`, `dy` to its end, `end` the end's y.

    `slope` is dx/dy, `inverse` 1 by the square of its length; 0 where that cannot be.
    """

    x: float
    y: float
    end: float
    dx: float
    dy: float
    slope: float
    inverse: float


@dataclass(frozen=True, slots=True)
class BoundingBox:
    """Where places near a polygon can lie: what is outside needs no closer look."""

    low_x: float
    high_x: float
    low_y: float
    high_y: float


def bounding_box(corners: Sequence[Point]) -> BoundingBox:
    """Return the box around a polygon, with the tolerance."""
    xs, ys = [each.x for each in corners], [each.y for each in corners]
    return BoundingBox(
        low_x=min(xs) - TOLERANCE,
        high_x=max(xs) + TOLERANCE,
        low_y=min(ys) - TOLERANCE,
        high_y=max(ys) + TOLERANCE,
    )


def polygon_edges(corners: Sequence[Point]) -> list[PolygonEdge]:
    """Return the edges of a polygon."""
    return [_polygon_edge(corners[index - 1], corner) for index, corner in enumerate(corners)]


def _polygon_edge(start: Point, end: Point) -> PolygonEdge:
    dx, dy = end.x - start.x, end.y - start.y
    square = dx * dx + dy * dy
    return PolygonEdge(
        x=start.x,
        y=start.y,
        end=end.y,
        dx=dx,
        dy=dy,
        slope=dx / dy if dy else 0.0,
        inverse=1 / square if square else 0.0,
    )


@dataclass(frozen=True, slots=True)
class PlanarTransform:
    """A turn, given by its cosine and sine, and then a move."""

    cosine: float
    sine: float
    x: float
    y: float

    def apply(self, x: float, y: float) -> XY:
        """Return where a place comes to lie."""
        return (self.cosine * x - self.sine * y + self.x, self.sine * x + self.cosine * y + self.y)

    def inverse(self) -> "PlanarTransform":
        """Return the motion back."""
        back = PlanarTransform(self.cosine, -self.sine, 0.0, 0.0)
        x, y = back.apply(self.x, self.y)
        return PlanarTransform(self.cosine, -self.sine, -x, -y)


def planar_transform(transform: Transform) -> PlanarTransform:
    """Return what takes a place in the frame `source` into the frame `target`."""
    return PlanarTransform(
        math.cos(transform.yaw), math.sin(transform.yaw), transform.x, transform.y
    )
