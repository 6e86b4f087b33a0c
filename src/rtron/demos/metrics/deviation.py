"""How far one way is from another."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist, hypot

from rtron.demos.world.ground_truth import Position

_STEP = 0.02
"""Places of a way nearer to each other than this (m) count as one: a rest does not weigh."""


@dataclass(frozen=True, slots=True)
class TrajectoryDeviation:
    """The largest and the mean distance (m) of a way's places from another way."""

    largest: float
    mean: float


def measure_deviation(
    trajectory: Sequence[Position], reference: Sequence[Position]
) -> TrajectoryDeviation | None:
    """Return the distances of `trajectory` from the line `reference`; None if either is empty."""
    if not trajectory or not reference:
        return None
    line = _without_rests(reference)
    distances = [_distance(position, line) for position in _without_rests(trajectory)]
    return TrajectoryDeviation(max(distances), sum(distances) / len(distances))


def _without_rests(trajectory: Sequence[Position]) -> list[Position]:
    thinned = [trajectory[0]]
    for position in trajectory:
        if dist(position, thinned[-1]) >= _STEP:
            thinned.append(position)
    return thinned


def _distance(position: Position, line: Sequence[Position]) -> float:
    if len(line) == 1:
        return dist(position, line[0])
    return min(_distance_from_segment(position, *segment) for segment in pairwise(line))


def _distance_from_segment(position: Position, start: Position, end: Position) -> float:
    """Return the distance of a place from the straight line between two others, its ends too."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    along = (position[0] - start[0]) * dx + (position[1] - start[1]) * dy
    part = min(1.0, max(0.0, along / (dx * dx + dy * dy)))
    return hypot(position[0] - start[0] - part * dx, position[1] - start[1] - part * dy)
