"""How fast the robot may drive, from what the camera shows."""

from collections.abc import Iterable

from .recognition import PEDESTRIAN, Detection

CRUISE = 0.22
NEAR_PEOPLE = 0.15
PEOPLE_NEAR = 0.08
"""The share of the image from which on a pedestrian slows the robot, at some 2 m."""


def max_velocity(detections: Iterable[Detection]) -> float:
    """Return the maximal velocity, m/s."""
    near = any(each.kind == PEDESTRIAN and each.area >= PEOPLE_NEAR for each in detections)
    return NEAR_PEOPLE if near else CRUISE


class MaxVelocity:
    """The maximal velocity after the last image."""

    def __init__(self) -> None:
        self.value = CRUISE

    def update(self, detections: Iterable[Detection]) -> None:
        """Take the detections in an image."""
        self.value = max_velocity(detections)
