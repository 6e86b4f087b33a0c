"""Places and areas the plain way, which expressions are compared with."""

import math
from collections.abc import Sequence

from rtron.messages.expressions.geometry import XY
from rtron.vocabulary import Point

TOLERANCE = 1e-9


class Polygon:
    """An area: the places in a polygon and on its edge (even-odd rule)."""

    __slots__ = ("_edges", "_high", "_low")

    def __init__(self, corners: Sequence[Point]) -> None:
        self._edges = tuple((corners[index - 1], end) for index, end in enumerate(corners))
        xs, ys = [each.x for each in corners], [each.y for each in corners]
        self._low = min(xs) - TOLERANCE, min(ys) - TOLERANCE
        self._high = max(xs) + TOLERANCE, max(ys) + TOLERANCE

    def contains(self, place: XY) -> bool:
        """Tell whether a place lies inside; ValueError if it is not finite."""
        x, y = _finite(place)
        low, high = self._low, self._high
        if not (low[0] <= x <= high[0] and low[1] <= y <= high[1]):
            return False
        found = False
        for start, end in self._edges:
            if (start.y > y) != (end.y > y):
                crossing = start.x + (y - start.y) / (end.y - start.y) * (end.x - start.x)
                found ^= x < crossing
        return found or self._to_edge(place) <= TOLERANCE

    def distance(self, place: XY) -> float:
        """Return how far away a place is (m), 0 inside; ValueError if it is not finite."""
        return 0.0 if self.contains(place) else self._to_edge(place)

    def _to_edge(self, place: XY) -> float:
        return min(_to_segment(place, start, end) for start, end in self._edges)


def distance(one: XY, other: XY) -> float:
    """Return the distance of two places (m); ValueError if one is not finite."""
    return math.dist(_finite(one), _finite(other))


def _finite(place: XY) -> XY:
    if not (math.isfinite(place[0]) and math.isfinite(place[1])):
        raise ValueError("a position is not finite")
    return place


def _to_segment(place: XY, start: Point, end: Point) -> float:
    along = end.x - start.x, end.y - start.y
    length = along[0] ** 2 + along[1] ** 2
    to_place = place[0] - start.x, place[1] - start.y
    share = (to_place[0] * along[0] + to_place[1] * along[1]) / length if length else 0.0
    share = min(max(share, 0.0), 1.0)
    return math.hypot(to_place[0] - share * along[0], to_place[1] - share * along[1])
