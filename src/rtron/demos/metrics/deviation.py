"""How far one way is from another."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist, hypot

from rtron.demos.world.ground_truth import Place

_STEP = 0.02
"""Places of a way nearer to each other than this (m) count as one: a rest does not weigh."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """The largest and the mean distance (m) of a way's places from another way."""

    largest: float
    mean: float


def deviation(way: Sequence[Place], other: Sequence[Place]) -> Deviation | None:
    """Return how far the places of `way` are from the line `other`; None if either is empty."""
    if not way or not other:
        return None
    line = _thinned(other)
    distances = [_distance(place, line) for place in _thinned(way)]
    return Deviation(max(distances), sum(distances) / len(distances))


def _thinned(way: Sequence[Place]) -> list[Place]:
    kept = [way[0]]
    for place in way:
        if dist(place, kept[-1]) >= _STEP:
            kept.append(place)
    return kept


def _distance(place: Place, line: Sequence[Place]) -> float:
    if len(line) == 1:
        return dist(place, line[0])
    return min(_from_segment(place, *ends) for ends in pairwise(line))


def _from_segment(place: Place, start: Place, end: Place) -> float:
    """Return the distance of a place from the straight line between two others, its ends too."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    along = (place[0] - start[0]) * dx + (place[1] - start[1]) * dy
    part = min(1.0, max(0.0, along / (dx * dx + dy * dy)))
    return hypot(place[0] - start[0] - part * dx, place[1] - start[1] - part * dy)
