"""The world's server: simulated time goes on, and devices hear of it and are heard."""

import asyncio
import json
import logging
import time
from asyncio import IncompleteReadError, StreamReader, StreamWriter
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rtron.demos.apps.logic.demo_logic.device import LENGTHS, Head, encode
from rtron.demos.world import camera, ray_casting
from rtron.demos.world.robot_base import STEP, ZERO_VELOCITY
from rtron.demos.world.simulation import CAMERA_RATE, RobotSimulation

_LOG = logging.getLogger(__name__)
_LATE = 0.5
"""Wall s; a world that is later lets simulated time go slower, and does not run after it."""

_MAX_UNSENT = 64 * 1024
"""Bytes that may wait for a client; one that is more behind gets no states meanwhile."""


class StepClock:
    """Counts steps of `step` simulated s at `speed` simulated s a wall s, without drift."""

    def __init__(
        self, speed: float, step: float, wall: Callable[[], float] = time.monotonic
    ) -> None:
        self._pace = step / speed
        self._wall = wall
        self._next = wall() + self._pace
        self.lost_time = 0.0
        """Wall s by which simulated time went slower than it should."""

    def wait(self) -> float:
        """Return how long it is until the next step, wall s."""
        return max(0.0, self._next - self._wall())

    def is_due(self) -> bool:
        """Tell whether a step is due; if so it is counted as made."""
        late = self._wall() - self._next
        if late < 0:
            return False
        if late > _LATE:
            self.lost_time += late
            self._next += late
        self._next += self._pace
        return True

    def step_fraction(self) -> float:
        """Return how much of the present step has passed, 0 to 1."""
        return max(0.0, min(1.0, 1.0 - (self._next - self._wall()) / self._pace))


class WorldServer:
    """Serves a world to the devices of a robot, and to `owner`, who runs the experiment.

    A client's first frame names its role. The base sends velocities, and the owner orders. To the
    others the world is a sender of states, of which a client that is behind misses some.
    """

    def __init__(self, speed: float) -> None:
        self._world = RobotSimulation()
        self._roles: dict[StreamWriter, str] = {}
        self._streams = DeviceStreams(self._world)
        self._clock = StepClock(speed, STEP)
        self._image_rate = CAMERA_RATE

    async def run(self, path: Path) -> None:
        """Serve on a Unix socket until the task is cancelled."""
        server = await asyncio.start_unix_server(self._serve, path)
        try:
            while True:
                await asyncio.sleep(self._clock.wait())
                if self._clock.is_due():  # no more than one: who is late must not be deaf as well
                    self._step()
        finally:
            server.close()
            if self._clock.lost_time:
                _LOG.warning("the world was %.1f s too slow in all", self._clock.lost_time)

    def _step(self) -> None:
        if "base" not in self._roles.values():  # nobody drives the robot any more
            self._world.set_velocity(ZERO_VELOCITY, 0.0)
        self._world.step()
        for role in self._streams.due():
            if listening := [w for w in self._clients(role) if not _is_behind(w)]:
                self._send(listening, self._streams.frame(role))

    def _clients(self, role: str) -> list[StreamWriter]:
        return [writer for writer, of in self._roles.items() if of == role]

    def _send(self, writers: list[StreamWriter], frame: bytes) -> None:
        for writer in writers:
            writer.write(frame)

    async def _serve(self, reader: StreamReader, writer: StreamWriter) -> None:
        """Serve a client until it, or the world, ends; one that sends no frames is let go."""
        try:
            self._begin(writer, (await _read_head(reader))["hello"])
            while True:
                self._handle(writer, await _read_head(reader))
        except (IncompleteReadError, ConnectionError):
            pass
        except (ValueError, TypeError, LookupError):
            _LOG.exception("a %s broke the protocol", self._roles.get(writer, "stranger"))
        finally:
            self._roles.pop(writer, None)
            writer.close()

    def _begin(self, writer: StreamWriter, role: str) -> None:
        self._roles[writer] = role
        if role == "computer":
            writer.write(encode({"rate": self._image_rate}))

    def _handle(self, writer: StreamWriter, head: Head) -> None:
        if self._roles[writer] == "base":
            v, w = head["velocity"]
            self._world.set_velocity((float(v), float(w)), self._clock.step_fraction())
        elif self._roles[writer] == "owner":
            answer = self._execute(head)
            writer.write(encode({"t": self._world.t, "run": self._world.run, **answer}))
        else:
            raise ValueError("it has nothing to say")

    def _execute(self, order: Head) -> Head:
        """Do what the owner asks for, and return what is to be answered."""
        match order:
            case {"order": "reset", "case": case, "seed": seed, "camera_rate": rate}:
                self._world.reset(case, seed, rate)
            case {"order": "start"}:
                self._start()
            case {"order": "rate", "rate": rate}:
                self._image_rate = rate
                self._send(self._clients("computer"), encode({"rate": rate}))
            case {"order": "devices"}:
                return {"roles": Counter(self._roles.values())}
            case _:
                raise ValueError("there is no such order")
        return {}

    def _start(self) -> None:
        self._world.start()
        scene = self._world.scene
        if not scene.is_teleoperated:
            self._send(self._clients("mission"), encode({"goal": scene.goal}))


def _is_behind(writer: StreamWriter) -> bool:
    return writer.transport.get_write_buffer_size() > _MAX_UNSENT


async def _read_head(reader: StreamReader) -> Head:
    """Return the head of the next frame; what clients send has no blob."""
    head, blob = LENGTHS.unpack(await reader.readexactly(LENGTHS.size))
    value: Head = json.loads(await reader.readexactly(head + blob))
    return value


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
        angle_increment=ray_casting.INCREMENT,
        range_min=ray_casting.RANGE_MIN,
        range_max=ray_casting.RANGE_MAX,
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
