"""Rays from one place to what stands around: the lidar's and the camera's geometry, vectorised."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rtron.demos.world.ground_truth import Position
from rtron.demos.world.scenes.scene import Pose, RoundObstacle, Scene

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Surfaces:
    """What rays can meet: edges (n, 4: two ends) and discs (m, 3: centre and radius), m."""

    edges: Floats
    discs: Floats

    def with_discs(self, centers: Sequence[Position], radius: float) -> "Surfaces":
        """Return these surfaces and more discs, which come last."""
        more = np.array([(x, y, radius) for x, y in centers]).reshape(-1, 3)
        return Surfaces(self.edges, np.concatenate([self.discs, more]))


def scene_surfaces(scene: Scene) -> Surfaces:
    """Return the surfaces of a scene: edges of walls, then those of blocks, and the discs."""
    edges = list(scene.walls)
    discs = []
    for obstacle in scene.obstacles:
        if isinstance(obstacle, RoundObstacle):
            discs.append((*obstacle.center, obstacle.radius))
        else:
            corners = obstacle.polygon
            pairs = zip(corners, corners[1:] + corners[:1], strict=True)
            edges += [(*a, *b) for a, b in pairs]
    return Surfaces(np.array(edges).reshape(-1, 4), np.array(discs).reshape(-1, 3))


def cast_rays(targets: Surfaces, origin: Position, angles: Floats) -> Floats:
    """Return how far it is along each angle (rays) to each edge, then to each disc (columns).

    Shape (rays, edges + discs); infinite where a ray does not meet a surface.
    """
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    at = np.asarray(origin, dtype=np.float64)
    return np.concatenate(
        [_to_edges(targets.edges, at, rays), _to_discs(targets.discs, at, rays)], 1
    )


def _to_edges(edges: Floats, at: Floats, rays: Floats) -> Floats:
    first, along = edges[:, :2] - at, edges[:, 2:] - edges[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):  # a ray along an edge does not meet it
        across = _cross(rays[:, None], along[None])
        far = _cross(first, along)[None] / across
        share = _cross(first[None], rays[:, None]) / across
        met = (far >= 0) & (share >= 0) & (share <= 1)
    return np.where(met, far, np.inf)


def _to_discs(discs: Floats, at: Floats, rays: Floats) -> Floats:
    centres = discs[:, :2] - at
    along = rays @ centres.T
    rest = discs[:, 2] ** 2 - (centres**2).sum(axis=1) + along**2
    with np.errstate(invalid="ignore"):
        far = along - np.sqrt(rest)
        return np.where((rest >= 0) & (along > 0), np.maximum(far, 0.0), np.inf)


def _cross(a: Floats, b: Floats) -> Floats:
    crossed: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return crossed


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
