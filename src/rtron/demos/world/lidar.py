"""The robot's 360-degree laser scanner."""

from math import pi

import numpy as np

from rtron.demos.world.ray_casting import Surfaces, cast_rays
from rtron.demos.world.scenes.scene import Pose

RANGE_MIN, RANGE_MAX = 0.12, 3.5
"""m."""
RAYS = 360
INCREMENT = 2 * pi / RAYS
"""rad, counter-clockwise; the first ray goes straight ahead."""
_ANGLES = np.linspace(0.0, 2 * pi, RAYS, endpoint=False)


def scan(surfaces: Surfaces, pose: Pose) -> bytes:
    """Return 360 ranges as little-endian float32, m; infinite where nothing is within reach."""
    ranges = cast_rays(surfaces, pose[:2], pose[2] + _ANGLES).min(axis=1)
    clipped = np.where(ranges > RANGE_MAX, np.inf, np.maximum(ranges, RANGE_MIN))
    return clipped.astype("<f4").tobytes()
