"""A served collector, and guards that talk to it over real WebSockets."""

import socket
import time
from contextlib import asynccontextmanager, contextmanager
from threading import Thread

import uvicorn
from fastapi import FastAPI
from websockets.sync.client import connect

from rtron.service.collector.data_collector import Collector, Patience
from rtron.service.collector.websocket_endpoint import router
from rtron.service.config import Config
from rtron.service.live.hub import Hub
from rtron.service.server.http import settings as serving
from rtron.service.store.retention import Bounds
from rtron.vocabulary import Plan, Settings
from rtron.wire.common.link_protocol import (
    Events,
    Hello,
    NewSettings,
    Stored,
    guard_bytes,
    to_guard,
)

LIMIT_S = 60
TOKENS = {"secret-one": "one", "secret-two": "two"}


def until(condition):
    """Wait until something holds."""
    deadline = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < deadline, "it did not come"
        time.sleep(0.005)


class Controller:
    """Says what to put in force, and remembers what it was told."""

    def __init__(self):
        self.greeted, self.answers = [], []
        self.settings = Settings(revision=1)
        self.refuse = None
        self.on_greet = lambda: None

    def greet(self, robot, hello):
        found = self.settings
        self.greeted.append((robot, hello))
        self.on_greet()
        if self.refuse:
            raise self.refuse
        return found

    def answered(self, robot, applied):
        self.answers.append((robot, applied))


class World:
    """A collector behind a server in a thread."""

    def __init__(self, database, **patience):
        self.hub, self.controller, self.tokens = Hub(), Controller(), dict(TOKENS)
        self.collector = Collector(
            database=database,
            hub=self.hub,
            greeting=self.controller,
            authenticate=self.tokens.get,
            clock=time.time_ns,
            bounds=Bounds(),
            patience=Patience(**patience),
        )
        self.tally = self.collector.tally
        self.port = 0

    @contextmanager
    def serving(self):
        """Serve until the end of the block."""
        app = FastAPI(lifespan=self._running)
        app.include_router(router)
        app.state.collector = self.collector
        listening = socket.create_server(("127.0.0.1", 0))
        self.port = listening.getsockname()[1]
        options = {**serving(Config()), "host": "127.0.0.1", "port": self.port}
        server = uvicorn.Server(uvicorn.Config(app, **options))
        thread = Thread(target=server.run, kwargs={"sockets": [listening]})
        thread.start()
        until(lambda: server.started)
        try:
            yield self
        finally:
            server.should_exit = True
            thread.join(LIMIT_S)
            assert not thread.is_alive()

    @asynccontextmanager
    async def _running(self, app):
        async with self.collector.running():
            yield

    def connect(self, token="secret-one", **options):
        """Connect as a guard's link process does."""
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        url = f"ws://127.0.0.1:{self.port}/link/v1"
        options = {"compression": None, "max_size": 1 << 24, "proxy": None, **options}
        return connect(url, additional_headers=headers, **options)

    @contextmanager
    def guard(self, token="secret-one", **values):
        """Give a guard that has said hello and has its settings."""
        with self.connect(token) as socket:
            say(socket, hello(**values))
            assert isinstance(hear(socket), NewSettings)
            yield socket


def hello(**values):
    """Make a guard's hello."""
    return Hello(
        **{"app": "app", "plan": Plan(app="app"), "run": "r", "began": 1, "version": "1"} | values
    )


def say(socket, message):
    """Send a message."""
    socket.send(guard_bytes(message), text=True)


def hear(socket):
    """Receive a message."""
    return to_guard(socket.recv(timeout=LIMIT_S))


def tell(socket, events):
    """Send events; return up to which number they are stored."""
    say(socket, Events(events=tuple(events)))
    stored = hear(socket)
    assert isinstance(stored, Stored)
    return stored.run, stored.number
