"""The world's loop: simulated time goes on, and whoever is connected hears of it and is heard."""

import logging
import selectors
import socket
from functools import partial

from rtron.demos.world.clock import Clock
from rtron.demos.world.robot_base import STEP
from rtron.demos.world.server.connection import Connection
from rtron.demos.world.server.connection_registry import Crowd
from rtron.demos.world.server.device_streams import Feeds
from rtron.demos.world.server.request_handler import Desk
from rtron.demos.world.simulation import World

_LOG = logging.getLogger(__name__)


class Server:
    """Serves a world on a listening socket. Only `stop` may be called from another thread."""

    def __init__(self, listener: socket.socket, speed: float, key: str) -> None:
        self._listener = listener
        self._world = World()
        self._selector = selectors.DefaultSelector()
        self._crowd = Crowd(self._selector)
        self._desk = Desk(self._world, self._crowd, speed, key)
        self._feeds = Feeds(self._world)
        self._clock = Clock(speed, STEP)
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
                self._turn()
        finally:
            self._crowd.drop_all()
            self._selector.close()
        if self._clock.lost:
            _LOG.warning("the world was %.1f s too slow in all", self._clock.lost)

    def _turn(self) -> None:
        for key, _ in self._selector.select(self._clock.wait()):
            if key.data is None:
                self._crowd.accept(self._listener)
            else:
                self._crowd.attend(key.data, partial(self._hear, key.data))
        if self._clock.is_due():  # no more than one: who is late must not be deaf as well
            self._step()

    def _hear(self, connection: Connection) -> None:
        connection.flush()
        for frame in connection.received():
            self._desk.take(connection, frame, self._clock.share())

    def _step(self) -> None:
        self._desk.forget_base()
        self._world.step()
        self._desk.announce()
        self._crowd.drop_silent()
        for role in self._feeds.due():
            if self._crowd.of(role):
                self._crowd.show(role, self._feeds.frame(role))
