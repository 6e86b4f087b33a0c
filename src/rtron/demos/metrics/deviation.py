"""How far one way is from another."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import dist

import shapely

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
    line = shapely.LineString([*reference, reference[-1]])
    distances = shapely.distance(line, shapely.points(_without_rests(trajectory)))
    return TrajectoryDeviation(float(distances.max()), float(distances.mean()))


def _without_rests(trajectory: Sequence[Position]) -> list[Position]:
    thinned = [trajectory[0]]
    for position in trajectory:
        if dist(position, thinned[-1]) >= _STEP:
            thinned.append(position)
    return thinned
