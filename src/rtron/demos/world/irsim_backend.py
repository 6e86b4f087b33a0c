"""IR-SIM with the scene in it: the robot's motion, and what it touches.

IR-SIM chooses a window system and talks about it when it is imported, and its log goes to
standard output; neither is wanted of a world that nobody looks at.
"""

import importlib
import io
import warnings
from collections.abc import Sequence
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml

from rtron.demos.world import robot_base
from rtron.demos.world.ground_truth import Position
from rtron.demos.world.robot_base import Velocity
from rtron.demos.world.scenes.scene import Obstacle, Pose, RoundObstacle, Scene

_OUTSIDE = (-100.0, -100.0)
"""Where a pedestrian is who is not there, m."""


@cache
def _irsim() -> Any:  # noqa: ANN401 - it has no types
    with warnings.catch_warnings(), redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        return importlib.import_module("irsim")


class IrSimBackend:
    """A robot in a scene, with as many pedestrians as it has crossings."""

    def __init__(self, scene: Scene) -> None:
        with TemporaryDirectory(prefix="rtron-world-") as folder:
            path = Path(folder, "world.yaml")
            path.write_text(yaml.safe_dump(_world(scene)), encoding="utf-8")
            self._env = _irsim().make(str(path), headless=True, log_level="CRITICAL")
        count = len(scene.crossings)
        self._pedestrians = self._env.obstacle_list[-count:] if count else []

    @property
    def pose(self) -> Pose:
        """x, y (m) and heading (rad)."""
        x, y, heading = self._env.robot.state[:3, 0].tolist()
        return x, y, heading

    @property
    def velocity(self) -> Velocity:
        """m/s and rad/s."""
        v, w = self._env.robot.velocity[:2, 0].tolist()
        return v, w

    @property
    def collided(self) -> bool:
        """Whether the robot touches something now."""
        return bool(self._env.robot.collision)

    def step(self, target_velocity: Velocity, pedestrians: Sequence[Position | None]) -> None:
        """Go on by a step, with the motors told to reach a velocity, and people at their places."""
        for pedestrian, position in zip(self._pedestrians, pedestrians, strict=True):
            pedestrian.set_state([*(position or _OUTSIDE), 0.0])
        self._env.step(np.array(target_velocity).reshape(2, 1))
        self._env.robot.trajectory.clear()  # nobody asks for it, and a world may live for long

    def halt(self) -> None:
        """Stop the robot where it is."""
        self._env.robot.set_velocity([0.0, 0.0])


def _world(scene: Scene) -> dict[str, Any]:
    """Return a scene as IR-SIM wants it."""
    width, height = scene.size
    walls = [_edge(*wall) for wall in scene.walls]
    people = [_round(_OUTSIDE, robot_base.PEDESTRIAN_RADIUS) for _ in scene.crossings]
    return {
        "world": {
            "width": width,
            "height": height,
            "step_time": robot_base.STEP,
            "sample_time": robot_base.STEP,
            "collision_mode": "stop",
        },
        "robot": [_robot(scene.start)],
        "obstacle": [*walls, *map(_obstacle, scene.obstacles), *people],
    }


def _robot(start: Pose) -> dict[str, Any]:
    return {
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": robot_base.RADIUS},
        "state": list(start),
        "vel_max": list(robot_base.MAX_VELOCITY),
        "vel_min": [-most for most in robot_base.MAX_VELOCITY],
        "acce": list(robot_base.MAX_ACCELERATION),
    }


def _edge(x1: float, y1: float, x2: float, y2: float) -> dict[str, Any]:
    shape = {"name": "linestring", "vertices": [[x1, y1], [x2, y2]]}
    return {"shape": shape, "state": [0, 0, 0]}


def _round(center: Position, radius: float) -> dict[str, Any]:
    return {"shape": {"name": "circle", "radius": radius}, "state": [*center, 0]}


def _obstacle(obstacle: Obstacle) -> dict[str, Any]:
    if isinstance(obstacle, RoundObstacle):
        return _round(obstacle.center, obstacle.radius)
    vertices = [list(corner) for corner in obstacle.polygon]
    return {"shape": {"name": "polygon", "vertices": vertices}, "state": [0, 0, 0]}
