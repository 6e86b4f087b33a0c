"""What the devices send by themselves, and how often in simulated time."""

from collections.abc import Callable
from typing import Any

from rtron.demos.world import camera, lidar
from rtron.demos.world.server.protocol import encode_frame
from rtron.demos.world.server.requests import ClientRole
from rtron.demos.world.simulation import RobotSimulation

_EARLY = 1e-6
_EACH_STEP = 20.0
_LIDAR_RATE, _BATTERY_RATE = 5.0, 1.0
"""Hz."""


class DeviceStreams:
    """Asked after each step for the frame of a role, if one is due; made only if asked for."""

    def __init__(self, world: RobotSimulation) -> None:
        self._world = world
        self._next: dict[ClientRole, float] = {}

    def due(self) -> list[ClientRole]:
        """Return the roles that have something to say after this step."""
        now = self._world.t
        found = [role for role in _ENCODERS if self._next.get(role, 0.0) <= now + _EARLY]
        for role in found:
            period = 1.0 / self._rate(role)
            self._next[role] = max(self._next.get(role, now) + period, now + _EARLY)
        return found

    def frame(self, role: ClientRole) -> bytes:
        """Return what a role has to say now."""
        return _ENCODERS[role](self._world)

    def _rate(self, role: ClientRole) -> float:
        return self._world.camera_rate if role is ClientRole.CAMERA else _RATES[role]


def _stamp(world: RobotSimulation, **rest: Any) -> dict[str, Any]:  # noqa: ANN401 - JSON
    return {"t": world.t, **rest}


def _base(world: RobotSimulation) -> bytes:
    pose, velocity = world.motion()
    return encode_frame(_stamp(world, pose=pose, velocity=velocity, run=world.run))


def _lidar(world: RobotSimulation) -> bytes:
    head = _stamp(
        world,
        angle_min=0.0,
        angle_increment=lidar.INCREMENT,
        range_min=lidar.RANGE_MIN,
        range_max=lidar.RANGE_MAX,
        run=world.run,
    )
    return encode_frame(head, world.lidar_scan())


def _camera(world: RobotSimulation) -> bytes:
    head = _stamp(world, width=camera.WIDTH, height=camera.HEIGHT, run=world.run)
    return encode_frame(head, world.camera_image())


def _battery(world: RobotSimulation) -> bytes:
    t = world.t
    return encode_frame(_stamp(world, percentage=battery_percentage(t), voltage=battery_voltage(t)))


def _owner(world: RobotSimulation) -> bytes:
    return encode_frame({"truth": world.truth().as_json()})


_ENCODERS: dict[ClientRole, Callable[[RobotSimulation], bytes]] = {
    ClientRole.BASE: _base,
    ClientRole.LIDAR: _lidar,
    ClientRole.CAMERA: _camera,
    ClientRole.BATTERY: _battery,
    ClientRole.OWNER: _owner,
}
_RATES = {
    ClientRole.BASE: _EACH_STEP,
    ClientRole.LIDAR: _LIDAR_RATE,
    ClientRole.BATTERY: _BATTERY_RATE,
    ClientRole.OWNER: _EACH_STEP,
}

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
