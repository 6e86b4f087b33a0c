"""The robot's camera: 320 x 240 rgb8, a column ray caster with a clear colour for each thing.

The colours are exact, with no shading or noise, and nothing else has them:

- a pedestrian's body is magenta (255, 0, 255), from the floor to 1.7 m, 0.34 m wide
- the lamp of a traffic light is red (255, 0, 0) or green (0, 255, 0), a disc of 0.14 m
- all else is grey, red = green = blue: ceiling, floor, walls, obstacles, the light's case

The lens is a pinhole with 62.2 degrees (a Raspberry Pi camera) 0.15 m above the floor, in the
robot's middle, and the focal length is 265 pixels. So a pedestrian at a distance of d m fills about
90 / d columns and 120 + 40 / d rows (at 1 m 19 % of the image), a lamp's diameter is
37 / d pixels, and its middle is 53 / d rows above the image's.
"""

from collections.abc import Sequence
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.ray_casting import Floats, Surfaces, cast_rays
from rtron.demos.world.robot_base import PEDESTRIAN_RADIUS
from rtron.demos.world.scenes.scene import Pose

WIDTH, HEIGHT = 320, 240
PEDESTRIAN = (255, 0, 255)
RED, GREEN = (255, 0, 0), (0, 255, 0)
FIELD_OF_VIEW = np.radians(62.2)
FOCAL = WIDTH / 2 / np.tan(FIELD_OF_VIEW / 2)
"""Pixels."""
LAMP_HEIGHT, LAMP_RADIUS = 0.35, 0.07
"""m; the lamp's middle."""
_EYE, _WALL_TOP, _PEDESTRIAN_TOP = 0.15, 2.0, 1.7
_NEAREST = 0.02
_CASE = 1.5
_CEILING, _FLOOR, _WALL, _OBSTACLE, _BODY, _LAMP_CASE, _LAMP = range(7)
_GREYS = ((200,) * 3, (90,) * 3, (150,) * 3, (120,) * 3, PEDESTRIAN, (40,) * 3)
_ROWS = np.arange(HEIGHT, dtype=np.int16)[:, None]
_COLUMNS = np.arange(WIDTH)
_ACROSS = WIDTH / 2 - 0.5 - _COLUMNS
"""Pixels to the left of the middle."""
_BEARINGS = np.arctan2(_ACROSS, FOCAL)

Image = NDArray[np.uint8]


def render_image(
    surfaces: Surfaces,
    walls: int,
    pose: Pose,
    pedestrians: Sequence[Position],
    lamp: tuple[Position, str] | None,
) -> Image:
    """Return what the camera sees, shape (240, 320, 3).

    `walls` of the edges come first in `surfaces` and are walls. The lamp has a place and "red" or
    "green".
    """
    everything = surfaces.with_discs(pedestrians, PEDESTRIAN_RADIUS)
    depths = cast_rays(everything, pose[:2], pose[2] + _BEARINGS) * np.cos(_BEARINGS)[:, None]
    nearest = depths.argmin(axis=1)
    depth = np.maximum(depths[_COLUMNS, nearest], _NEAREST)
    people = nearest >= depths.shape[1] - len(pedestrians)
    kinds = np.where(people, _BODY, np.where(nearest < walls, _WALL, _OBSTACLE))
    painted = _columns(kinds.astype(np.uint8), depth, people)
    colour = RED if lamp and lamp[1] == "red" else GREEN
    if lamp is not None:
        _paint_lamp(painted, depth, pose, lamp[0])
    return np.array([*_GREYS, colour], dtype=np.uint8).take(painted, axis=0)


def _columns(kinds: Image, depth: Floats, people: NDArray[np.bool_]) -> Image:
    tops = np.where(people, _PEDESTRIAN_TOP, _WALL_TOP)
    top = _row(HEIGHT / 2 - (tops - _EYE) * FOCAL / depth)
    bottom = _row(HEIGHT / 2 + _EYE * FOCAL / depth)
    below = np.where(bottom > _ROWS, kinds, np.uint8(_FLOOR))
    painted: Image = np.where(top > _ROWS, np.uint8(_CEILING), below)
    return painted


def _row(height: Floats) -> NDArray[np.int16]:
    """Return the first row at or below a height on the image."""
    return np.ceil(np.clip(height, 0, HEIGHT)).astype(np.int16)


def _paint_lamp(painted: Image, depth: Floats, pose: Pose, position: Position) -> None:
    """Paint the lamp in its case, where nothing stands before it."""
    dx, dy = position[0] - pose[0], position[1] - pose[1]
    ahead, left = (dx * cos(pose[2]) + dy * sin(pose[2]), dy * cos(pose[2]) - dx * sin(pose[2]))
    if ahead < 2 * LAMP_RADIUS:
        return
    scale = FOCAL / ahead
    size = LAMP_RADIUS * scale
    free = depth > ahead - LAMP_RADIUS
    columns = np.flatnonzero((abs(_ACROSS - left * scale) <= _CASE * size) & free)
    x = _ACROSS[columns] - left * scale
    y = _ROWS - (HEIGHT / 2 - (LAMP_HEIGHT - _EYE) * scale)
    part = painted[:, columns]
    part[np.broadcast_to(abs(y) <= _CASE * size, part.shape)] = _LAMP_CASE
    part[x**2 + y**2 <= size**2] = _LAMP
    painted[:, columns] = part
