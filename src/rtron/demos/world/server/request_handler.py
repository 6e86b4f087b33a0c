"""What the clients' frames do: a hello, a velocity, an order."""

import hmac
from collections import Counter
from typing import Any

from rtron.demos.world.command import STILL
from rtron.demos.world.server import requests
from rtron.demos.world.server.connection import Connection
from rtron.demos.world.server.connection_registry import Crowd
from rtron.demos.world.server.protocol import Frame, Head
from rtron.demos.world.server.requests import Devices, Order, Rate, Reset, Role, Start
from rtron.demos.world.simulation import World
from rtron.errors import WireError


class Desk:
    """Takes frames; `share` tells how much of the present step has passed (0 to 1)."""

    def __init__(self, world: World, crowd: Crowd, speed: float, key: str) -> None:
        self._world, self._crowd, self._speed, self._key = world, crowd, speed, key.encode()
        self._rate = requests.CAMERA_RATE
        self._network = world.network

    def take(self, connection: Connection, frame: Frame, share: float) -> None:
        """Do what a frame asks for; WireError if its sender may not ask for it."""
        if connection.role is None:
            self._greet(connection, frame.head)
        elif connection.role is Role.BASE:
            self._world.command(requests.velocity(frame.head), share)
        elif connection.role is Role.OWNER:
            connection.must(self._obey(requests.order(frame.head)))
        else:
            raise WireError("has nothing to say")

    def announce(self) -> None:
        """Tell of the network if it changed."""
        if self._network != self._world.network:
            self._network = self._world.network
            self._crowd.tell(Role.NETWORK, {"connected": self._network})

    def forget_base(self) -> None:
        """Stop the robot if nobody drives it any more."""
        if not self._crowd.of(Role.BASE):
            self._world.command(STILL, 0.0)

    def _greet(self, connection: Connection, head: Head) -> None:
        role = requests.role(head)
        if role is Role.OWNER and not self._is_key(head.get("key")):
            raise WireError("is no owner: its key is wrong")
        connection.role = role
        connection.must({"welcome": role.value, "speed": self._speed, "t": self._world.t})
        if role is Role.COMPUTER:
            connection.must({"rate": self._rate})
        elif role is Role.NETWORK:
            connection.must({"connected": self._network})

    def _is_key(self, key: Any) -> bool:  # noqa: ANN401 - a stranger's
        said = key if isinstance(key, str) else ""
        return hmac.compare_digest(said.encode("utf-8", "replace"), self._key)

    def _obey(self, order: Order) -> Head:
        if isinstance(order, Reset):
            return self._reset(order)
        if isinstance(order, Start):
            return self._start()
        if isinstance(order, Rate):
            return self._set_rate(order)
        return self._count(order)

    def _reset(self, order: Reset) -> Head:
        self._world.reset(order)
        return self._done("reset", run=self._world.run, scene=self._world.scene.as_json())

    def _start(self) -> Head:
        self._world.start()
        goal = {"t": self._world.t, "run": self._world.run, "goal": self._world.scene.goal}
        self._crowd.tell(Role.MISSION, goal)
        return self._done("start")

    def _set_rate(self, order: Rate) -> Head:
        if order.rate != self._rate:
            self._rate = order.rate
            self._crowd.tell(Role.COMPUTER, {"rate": self._rate})
        return self._done("rate")

    def _count(self, _order: Devices) -> Head:
        counted = Counter(each.role for each in self._crowd if each.role)
        return {"done": "devices", "roles": {role.value: counted[role] for role in Role}}

    def _done(self, what: str, **rest: Any) -> Head:  # noqa: ANN401 - JSON
        return {"done": what, "t": self._world.t, **rest}
