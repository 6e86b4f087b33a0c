"""What the devices send by themselves, and how often in simulated time."""

from collections.abc import Callable
from typing import Any

from rtron.demos.apps.logic.demo_logic.device import encode
from rtron.demos.world import camera, lidar
from rtron.demos.world.simulation import RobotSimulation

_EARLY = 1e-6
_EACH_STEP = 20.0
_LIDAR_RATE, _BATTERY_RATE = 5.0, 1.0
"""Hz."""


class DeviceStreams:
    """Asked after each step for the frame of a role, if one is due; made only if asked for."""

    def __init__(self, world: RobotSimulation) -> None:
        self._world = world
        self._next: dict[str, float] = {}

    def due(self) -> list[str]:
        """Return the roles that have something to say after this step."""
        now = self._world.t
        found = [role for role in _ENCODERS if self._next.get(role, 0.0) <= now + _EARLY]
        for role in found:
            period = 1.0 / _RATES.get(role, self._world.camera_rate)
            self._next[role] = max(self._next.get(role, now) + period, now + _EARLY)
        return found

    def frame(self, role: str) -> bytes:
        """Return what a role has to say now."""
        return _ENCODERS[role](self._world)


def _base(world: RobotSimulation) -> bytes:
    pose, velocity = world.motion()
    return _stamped(world, pose=pose, velocity=velocity)


def _lidar(world: RobotSimulation) -> bytes:
    return _stamped(
        world,
        world.lidar_scan(),
        angle_min=0.0,
        angle_increment=lidar.INCREMENT,
        range_min=lidar.RANGE_MIN,
        range_max=lidar.RANGE_MAX,
    )


def _camera(world: RobotSimulation) -> bytes:
    return _stamped(world, world.camera_image(), width=camera.WIDTH, height=camera.HEIGHT)


def _battery(world: RobotSimulation) -> bytes:
    t = world.t
    return _stamped(world, percentage=battery_percentage(t), voltage=battery_voltage(t))


def _owner(world: RobotSimulation) -> bytes:
    return encode({"truth": world.truth().as_json()})


def _stamped(world: RobotSimulation, blob: bytes = b"", **head: Any) -> bytes:  # noqa: ANN401 - JSON
    return encode({"t": world.t, **head}, blob)


_ENCODERS: dict[str, Callable[[RobotSimulation], bytes]] = {
    "base": _base,
    "lidar": _lidar,
    "camera": _camera,
    "battery": _battery,
    "owner": _owner,
}
_RATES = {
    "base": _EACH_STEP,
    "lidar": _LIDAR_RATE,
    "battery": _BATTERY_RATE,
    "owner": _EACH_STEP,
}
"""Hz, but of the camera, whose rate a run sets."""

_LASTS = 9000.0
"""Simulated s: two and a half hours."""
_EMPTY, _FULL = 11.1, 12.6
"""V."""


def battery_percentage(t: float) -> float:
    """Return what is left at `t` (simulated s since the world began), 0 to 1."""
    return max(0.0, 1.0 - t / _LASTS)


def battery_voltage(t: float) -> float:
    """Return the battery's voltage at `t` (simulated s since the world began), V."""
    return _EMPTY + (_FULL - _EMPTY) * battery_percentage(t)
