"""The world of a run, and the ways in it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from rtron.demos.world.ground_truth import GroundTruth, Position

SceneDocument = Mapping[str, Any]
"""The world of a run as `reset` answers it: walls, obstacles, area, light, start, goal."""
ROBOT_RADIUS = 0.105
"""Of a TurtleBot3 burger, m."""


def relative_to_start(began: float, truth: GroundTruth) -> GroundTruth:
    """Return the truth with its time counted from `began`, the start of its run (world s)."""
    return replace(truth, t=truth.t - began)


def position_of(truth: GroundTruth) -> Position:
    """Return where the robot is."""
    return truth.pose[0], truth.pose[1]


def trajectory_of(samples: Sequence[GroundTruth]) -> tuple[Position, ...]:
    """Return where the robot went, in order."""
    return tuple(map(position_of, samples))
