"""What the devices send by themselves, and how often in simulated time."""

from collections.abc import Callable
from typing import Any

from rtron.demos.world import battery, camera, lidar
from rtron.demos.world.server.protocol import encode
from rtron.demos.world.server.requests import Role
from rtron.demos.world.simulation import World

_EARLY = 1e-6
_EACH_STEP = 20.0
_LIDAR_RATE, _BATTERY_RATE = 5.0, 1.0
"""Hz."""


class Feeds:
    """Asked after each step for the frame of a role, if one is due; made only if asked for."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._next: dict[Role, float] = {}

    def due(self) -> list[Role]:
        """Return the roles that have something to say after this step."""
        now = self._world.t
        found = [role for role in _FRAMES if self._next.get(role, 0.0) <= now + _EARLY]
        for role in found:
            period = 1.0 / self._rate(role)
            self._next[role] = max(self._next.get(role, now) + period, now + _EARLY)
        return found

    def frame(self, role: Role) -> bytes:
        """Return what a role has to say now."""
        return _FRAMES[role](self._world)

    def _rate(self, role: Role) -> float:
        return self._world.camera_rate if role is Role.CAMERA else _RATES[role]


def _stamp(world: World, **rest: Any) -> dict[str, Any]:  # noqa: ANN401 - JSON
    return {"t": world.t, **rest}


def _base(world: World) -> bytes:
    pose, velocity = world.motion()
    return encode(_stamp(world, pose=pose, velocity=velocity, run=world.run))


def _lidar(world: World) -> bytes:
    head = _stamp(
        world,
        angle_min=0.0,
        angle_increment=lidar.INCREMENT,
        range_min=lidar.RANGE_MIN,
        range_max=lidar.RANGE_MAX,
        run=world.run,
    )
    return encode(head, world.scan())


def _camera(world: World) -> bytes:
    head = _stamp(world, width=camera.WIDTH, height=camera.HEIGHT, run=world.run)
    return encode(head, world.picture())


def _battery(world: World) -> bytes:
    t = world.t
    return encode(_stamp(world, percentage=battery.percentage(t), voltage=battery.voltage(t)))


def _owner(world: World) -> bytes:
    return encode({"truth": world.truth().as_json()})


_FRAMES: dict[Role, Callable[[World], bytes]] = {
    Role.BASE: _base,
    Role.LIDAR: _lidar,
    Role.CAMERA: _camera,
    Role.BATTERY: _battery,
    Role.OWNER: _owner,
}
_RATES = {
    Role.BASE: _EACH_STEP,
    Role.LIDAR: _LIDAR_RATE,
    Role.BATTERY: _BATTERY_RATE,
    Role.OWNER: _EACH_STEP,
}
