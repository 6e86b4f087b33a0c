"""The short beep of /speaker: 8 kHz, one byte a sample."""

from collections.abc import Iterable
from math import pi, sin

from .recognition import PEDESTRIAN, Detection

_RATE, _PITCH, _LENGTH, _LOUDNESS = 8000, 880, 0.1, 60
BEEP = bytes(
    128 + round(_LOUDNESS * sin(2 * pi * _PITCH * sample / _RATE))
    for sample in range(int(_RATE * _LENGTH))
)
_IMAGES_WITHOUT = 10


class Beeper:
    """Beeps once when a pedestrian comes into sight."""

    def __init__(self) -> None:
        self._without = _IMAGES_WITHOUT

    def beeps(self, detections: Iterable[Detection]) -> bool:
        """Return whether to beep: an image shows a pedestrian, and none did for a while."""
        if not any(each.kind == PEDESTRIAN for each in detections):
            self._without += 1
            return False
        came, self._without = self._without >= _IMAGES_WITHOUT, 0
        return came
