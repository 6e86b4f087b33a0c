"""The world of a run, and the ways in it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from rtron.demos.world.ground_truth import Place, Truth

Scene = Mapping[str, Any]
"""The world of a run as `reset` answers it: walls, obstacles, area, light, start, goal."""
ROBOT_RADIUS = 0.105
"""Of a TurtleBot3 burger, m."""


def since(began: float, truth: Truth) -> Truth:
    """Return the truth with its time counted from `began`, the start of its run (world s)."""
    return replace(truth, t=truth.t - began)


def place(truth: Truth) -> Place:
    """Return where the robot is."""
    return truth.pose[0], truth.pose[1]


def way(samples: Sequence[Truth]) -> tuple[Place, ...]:
    """Return where the robot went, in order."""
    return tuple(map(place, samples))
