"""Finds pedestrians and traffic lights in an image by their colours, and writes them as JSON."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from math import atan, isfinite, radians, tan

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
    """Return the detections in a text of /detect/objects; what is none of ours is left out."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return []
    entries = found if isinstance(found, list) else []
    return [_detection(each) for each in entries if _is_detection(each)]


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


def _detection(value: dict[str, float]) -> Detection:
    return Detection(str(value["kind"]), float(value["area"]), float(value["bearing"]))


def _is_detection(value: object) -> bool:
    return (
        isinstance(value, dict)
        and str(value.get("kind")) in COLOURS
        and all(_is_number(value.get(name)) for name in ("area", "bearing"))
    )


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)
