"""What the nodes make of the camera's images: detections by colour, and what follows from them."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from math import atan, pi, radians, sin, tan

PEDESTRIAN, RED_LIGHT, GREEN_LIGHT = "pedestrian", "red_light", "green_light"
COLOURS = {PEDESTRIAN: b"\xff\x00\xff", RED_LIGHT: b"\xff\x00\x00", GREEN_LIGHT: b"\x00\xff\x00"}
FIELD_OF_VIEW = radians(62.2)
"""Of the camera, from left to right, rad."""
_STRIDE = 4
_FEWEST = 2


@dataclass(frozen=True)
class Detection:
    """A thing in the image: the share of the image that it fills, and its bearing (rad, left +)."""

    kind: str
    area: float
    bearing: float


def recognise(image: bytes, width: int, height: int) -> list[Detection]:
    """Return what an rgb8 image shows, at most one of each kind, from every fourth pixel."""
    if not width or not height:
        return []
    found = {kind: _columns(image, width, height, colour) for kind, colour in COLOURS.items()}
    looked_at = len(range(0, width, _STRIDE)) * len(range(0, height, _STRIDE))
    return [
        Detection(kind, len(columns) / looked_at, _bearing(columns, width))
        for kind, columns in found.items()
        if len(columns) >= _FEWEST
    ]


def to_json(detections: Iterable[Detection]) -> str:
    """Return the text of the topic /detect/objects."""
    return json.dumps([asdict(each) for each in detections])


def from_json(text: str) -> list[Detection]:
    """Return the detections in a text of /detect/objects."""
    return [Detection(**each) for each in json.loads(text)]


def _columns(image: bytes, width: int, height: int, colour: bytes) -> list[int]:
    """Return the columns of the pixels looked at that have a colour, one entry a pixel."""
    columns: list[int] = []
    for start in range(0, height * width * 3, width * 3 * _STRIDE):
        row = image[start : start + width * 3]
        if colour in row:  # cheap, and rarely true
            columns += [at for at in range(0, width, _STRIDE) if row[at * 3 : at * 3 + 3] == colour]
    return columns


def _bearing(columns: list[int], width: int) -> float:
    middle = sum(columns) / len(columns)
    return atan((1 - 2 * middle / width) * tan(FIELD_OF_VIEW / 2))


_MAX_CREDIT = 2.0
_ROUNDING = 1e-6


class FrameLimiter:
    """Skips images so that at most `rate` a simulated second are processed."""

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self._credit = 1.0
        self._last: float | None = None

    def accepts(self, now: float) -> bool:
        """Return whether the image that came at `now` (simulated seconds) is processed."""
        if self._last is not None:
            self._credit += max(0.0, now - self._last) * self.rate
        self._last, self._credit = now, min(self._credit, _MAX_CREDIT)
        if self._credit < 1 - _ROUNDING:
            return False
        self._credit -= 1
        return True


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


CRUISE = 0.22
NEAR_PEOPLE = 0.15
PEOPLE_NEAR = 0.08
"""The share of the image from which on a pedestrian slows the robot, at some 2 m."""


class MaxVelocity:
    """How fast the robot may drive after the last image, m/s."""

    def __init__(self) -> None:
        self.value = CRUISE

    def update(self, detections: Iterable[Detection]) -> None:
        """Take the detections in an image."""
        near = any(each.kind == PEDESTRIAN and each.area >= PEOPLE_NEAR for each in detections)
        self.value = NEAR_PEOPLE if near else CRUISE


_RATE, _PITCH, _LENGTH, _LOUDNESS = 8000, 880, 0.1, 60
BEEP = bytes(
    128 + round(_LOUDNESS * sin(2 * pi * _PITCH * sample / _RATE))
    for sample in range(int(_RATE * _LENGTH))
)
_IMAGES_WITHOUT = 10


class Beeper:
    """Beeps (8 kHz, one byte a sample) once when a pedestrian comes into sight."""

    def __init__(self) -> None:
        self._without = _IMAGES_WITHOUT

    def beeps(self, detections: Iterable[Detection]) -> bool:
        """Return whether to beep: an image shows a pedestrian, and none did for a while."""
        if not any(each.kind == PEDESTRIAN for each in detections):
            self._without += 1
            return False
        came, self._without = self._without >= _IMAGES_WITHOUT, 0
        return came
