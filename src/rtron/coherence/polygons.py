"""Whether corners make a polygon: decided exactly, on a grid of micrometres."""

from collections.abc import Sequence
from itertools import combinations

from rtron.vocabulary import Point

MIN_CORNERS = 3
MAX_CORNERS = 100
_GRID = 1_000_000
_SQUARE_MILLIMETRE = 1_000_000
_Corner = tuple[int, int]
_Edge = tuple[_Corner, _Corner]


def polygon_problem(points: Sequence[Point]) -> str:
    """Return what keeps corners, in their order, from being an area; an empty text if nothing."""
    if not MIN_CORNERS <= len(points) <= MAX_CORNERS:
        return f"an area has {MIN_CORNERS} to {MAX_CORNERS} corners"
    corners = [(round(point.x * _GRID), round(point.y * _GRID)) for point in points]
    return _repeated(corners) or _misshapen(corners)


def _repeated(corners: Sequence[_Corner]) -> str:
    if corners[0] == corners[-1]:
        return "the last corner is the first one: leave it out"
    return "a corner stands there twice" if len(set(corners)) < len(corners) else ""


def _misshapen(corners: Sequence[_Corner]) -> str:
    if not any(_cross(corners[0], corners[1], corner) for corner in corners):
        return "the corners lie on one line"
    crossing = _crossing(corners)
    if crossing:
        return "the edges from corner {} and from corner {} cross".format(*crossing)
    small = abs(_doubled_area(corners)) < 2 * _SQUARE_MILLIMETRE
    return "the area is smaller than a square millimetre" if small else ""


def _doubled_area(corners: Sequence[_Corner]) -> int:
    return sum(_cross((0, 0), one, other) for one, other in _edges(corners))


def _edges(corners: Sequence[_Corner]) -> list[_Edge]:
    return list(zip(corners, [*corners[1:], corners[0]], strict=True))


def _crossing(corners: Sequence[_Corner]) -> tuple[int, int] | None:
    """Return the numbers, from 1, of two edges that meet where they should not."""
    edges = list(enumerate(_edges(corners), start=1))
    for (first, one), (second, other) in combinations(edges, 2):
        if _meet(one, other):
            return first, second
    return None


def _meet(one: _Edge, other: _Edge) -> bool:
    (a, b), (c, d) = one, other
    if b == c:
        return _folds(a, b, d)
    if a == d:
        return _folds(c, a, b)
    if not _boxes_meet(one, other):
        return False
    sides = _side(a, b, c) * _side(a, b, d), _side(c, d, a) * _side(c, d, b)
    return max(sides) <= 0


def _folds(before: _Corner, corner: _Corner, after: _Corner) -> bool:
    """Tell whether an edge goes back along the one before it."""
    (x, y), (p, q), (r, s) = corner, before, after
    return _cross(corner, before, after) == 0 and (p - x) * (r - x) + (q - y) * (s - y) > 0


def _boxes_meet(one: _Edge, other: _Edge) -> bool:
    return all(
        min(a, b) <= max(c, d) and min(c, d) <= max(a, b)
        for a, b, c, d in zip(*one, *other, strict=True)
    )


def _side(a: _Corner, b: _Corner, c: _Corner) -> int:
    turn = _cross(a, b, c)
    return (turn > 0) - (turn < 0)


def _cross(origin: _Corner, one: _Corner, other: _Corner) -> int:
    return (one[0] - origin[0]) * (other[1] - origin[1]) - (one[1] - origin[1]) * (
        other[0] - origin[0]
    )
