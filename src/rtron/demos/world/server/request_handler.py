"""What the clients' frames do: a hello, a velocity, an order."""

import hmac
from collections import Counter
from typing import Any

from rtron.demos.world.robot_base import ZERO_VELOCITY
from rtron.demos.world.server import requests
from rtron.demos.world.server.connection import DeviceConnection
from rtron.demos.world.server.connection_registry import ConnectionRegistry
from rtron.demos.world.server.protocol import DeviceFrame, Head
from rtron.demos.world.server.requests import (
    ClientRole,
    DevicesRequest,
    OwnerRequest,
    RateRequest,
    ResetRequest,
    StartRequest,
)
from rtron.demos.world.simulation import RobotSimulation
from rtron.errors import WireError


class RequestHandler:
    """Takes frames; `step_fraction` tells how much of the present step has passed (0 to 1)."""

    def __init__(
        self, world: RobotSimulation, connections: ConnectionRegistry, speed: float, key: str
    ) -> None:
        self._world, self._connections, self._speed, self._key = (
            world,
            connections,
            speed,
            key.encode(),
        )
        self._rate = requests.CAMERA_RATE
        self._network = world.network

    def handle(
        self, connection: DeviceConnection, frame: DeviceFrame, step_fraction: float
    ) -> None:
        """Do what a frame asks for; WireError if its sender may not ask for it."""
        if connection.role is None:
            self._identify(connection, frame.head)
        elif connection.role is ClientRole.BASE:
            self._world.set_velocity(requests.parse_velocity(frame.head), step_fraction)
        elif connection.role is ClientRole.OWNER:
            connection.send(self._execute(requests.parse_request(frame.head)))
        else:
            raise WireError("has nothing to say")

    def announce_network(self) -> None:
        """Tell of the network if it changed."""
        if self._network != self._world.network:
            self._network = self._world.network
            self._connections.send(ClientRole.NETWORK, {"connected": self._network})

    def stop_without_driver(self) -> None:
        """Stop the robot if nobody drives it any more."""
        if not self._connections.with_role(ClientRole.BASE):
            self._world.set_velocity(ZERO_VELOCITY, 0.0)

    def _identify(self, connection: DeviceConnection, head: Head) -> None:
        role = requests.parse_role(head)
        if role is ClientRole.OWNER and not self._is_key(head.get("key")):
            raise WireError("is no owner: its key is wrong")
        connection.role = role
        connection.send({"welcome": role.value, "speed": self._speed, "t": self._world.t})
        if role is ClientRole.COMPUTER:
            connection.send({"rate": self._rate})
        elif role is ClientRole.NETWORK:
            connection.send({"connected": self._network})

    def _is_key(self, key: Any) -> bool:  # noqa: ANN401 - a stranger's
        text = key if isinstance(key, str) else ""
        return hmac.compare_digest(text.encode("utf-8", "replace"), self._key)

    def _execute(self, order: OwnerRequest) -> Head:
        if isinstance(order, ResetRequest):
            return self._reset(order)
        if isinstance(order, StartRequest):
            return self._start()
        if isinstance(order, RateRequest):
            return self._set_rate(order)
        return self._count_devices(order)

    def _reset(self, order: ResetRequest) -> Head:
        self._world.reset(order)
        return self._reply("reset", run=self._world.run, scene=self._world.scene.as_json())

    def _start(self) -> Head:
        self._world.start()
        goal = {"t": self._world.t, "run": self._world.run, "goal": self._world.scene.goal}
        if not self._world.scene.is_teleoperated:
            self._connections.send(ClientRole.MISSION, goal)
        return self._reply("start")

    def _set_rate(self, order: RateRequest) -> Head:
        if order.rate != self._rate:
            self._rate = order.rate
            self._connections.send(ClientRole.COMPUTER, {"rate": self._rate})
        return self._reply("rate")

    def _count_devices(self, _order: DevicesRequest) -> Head:
        counted = Counter(each.role for each in self._connections if each.role)
        return {"done": "devices", "roles": {role.value: counted[role] for role in ClientRole}}

    def _reply(self, what: str, **rest: Any) -> Head:  # noqa: ANN401 - JSON
        return {"done": what, "t": self._world.t, **rest}
