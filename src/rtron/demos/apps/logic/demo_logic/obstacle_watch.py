"""When what the camera shows makes the robot stop: near people, red lights ahead."""

from collections.abc import Iterable

from .recognition import GREEN_LIGHT, PEDESTRIAN, RED_LIGHT, Detection

IN_A_ROW = 3
"""So many images must agree, in stopping and in going on."""
AHEAD = 0.4
"""Bearing to either side that counts as ahead, rad."""
NEAR = {PEDESTRIAN: 0.15, RED_LIGHT: 0.01}
"""From this share of the image on a thing is near: some 1.1 m to people, 1.2 m to a lamp."""


class ObstacleWatch:
    """Decides from images when the robot stops."""

    def __init__(self) -> None:
        self.stopped = False
        self._against = 0

    def update(self, detections: Iterable[Detection]) -> None:
        """Take the detections in an image; three images in a row that disagree change the state."""
        self._against = self._against + 1 if _in_the_way(detections) != self.stopped else 0
        if self._against >= IN_A_ROW:
            self.stopped, self._against = not self.stopped, 0


def _in_the_way(detections: Iterable[Detection]) -> bool:
    return any(
        each.kind != GREEN_LIGHT
        and each.area >= NEAR[each.kind]
        and (each.kind == RED_LIGHT or abs(each.bearing) <= AHEAD)
        for each in detections
    )
