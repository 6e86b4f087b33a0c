"""The world's loop: simulated time goes on, and whoever is connected hears of it and is heard."""

import logging
import selectors
import socket
import time
from collections.abc import Callable
from functools import partial

from rtron.demos.world.robot_base import STEP
from rtron.demos.world.server.connection import DeviceConnection
from rtron.demos.world.server.connection_registry import ConnectionRegistry
from rtron.demos.world.server.device_streams import DeviceStreams
from rtron.demos.world.server.request_handler import RequestHandler
from rtron.demos.world.simulation import RobotSimulation

_LATE = 0.5
"""Wall s; a world that is later lets simulated time go slower, and does not run after it."""


class StepClock:
    """Counts steps of `step` simulated s at `speed` simulated s a wall s, without drift."""

    def __init__(
        self, speed: float, step: float, wall: Callable[[], float] = time.monotonic
    ) -> None:
        self._pace = step / speed
        self._wall = wall
        self.lost_time = 0.0
        """Wall s by which simulated time went slower than it should."""
        self.restart()

    def restart(self) -> None:
        """Let the first step begin now."""
        self._next = self._wall() + self._pace

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


_LOG = logging.getLogger(__name__)


class WorldServer:
    """Serves a world on a listening socket. Only `stop` may be called from another thread."""

    def __init__(self, listener: socket.socket, speed: float, key: str) -> None:
        self._listener = listener
        self._world = RobotSimulation()
        self._selector = selectors.DefaultSelector()
        self._connections = ConnectionRegistry(self._selector)
        self._requests = RequestHandler(self._world, self._connections, speed, key)
        self._streams = DeviceStreams(self._world)
        self._clock = StepClock(speed, STEP)
        self._stopped = False

    def stop(self) -> None:
        """End `run` within a step."""
        self._stopped = True

    def run(self) -> None:
        """Serve until `stop`."""
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._clock.restart()
        try:
            while not self._stopped:
                self._run_once()
        finally:
            self._connections.drop_all()
            self._selector.close()
        if self._clock.lost_time:
            _LOG.warning("the world was %.1f s too slow in all", self._clock.lost_time)

    def _run_once(self) -> None:
        for key, _ in self._selector.select(self._clock.wait()):
            if key.data is None:
                self._connections.accept(self._listener)
            else:
                self._connections.serve(key.data, partial(self._read, key.data))
        if self._clock.is_due():  # no more than one: who is late must not be deaf as well
            self._step()

    def _read(self, connection: DeviceConnection) -> None:
        connection.flush()
        for frame in connection.read_frames():
            self._requests.handle(connection, frame, self._clock.step_fraction())

    def _step(self) -> None:
        self._requests.stop_without_driver()
        self._world.step()
        self._requests.announce_network()
        self._connections.drop_unidentified()
        for role in self._streams.due():
            if self._connections.with_role(role):
                self._connections.send_state(role, self._streams.frame(role))
