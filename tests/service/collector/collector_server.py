"""A served collector, and guards that talk to it over real WebSockets."""

import time
from contextlib import asynccontextmanager, contextmanager

from fastapi import FastAPI
from server_thread import LIMIT_S, serve_app
from service_app import SIGNER
from websockets.sync.client import connect

from rtron.service.collector.data_collector import ConnectionTimeouts, DataCollector
from rtron.service.collector.websocket_endpoint import router
from rtron.service.config import ServiceConfig
from rtron.service.domain.clock import SteadyClock
from rtron.service.live.hub import Hub
from rtron.service.server.http import uvicorn_options as serving
from rtron.service.store.retention import RetentionLimits
from rtron.vocabulary import Plan, Settings
from rtron.wire.common.link_protocol import (
    Events,
    Hello,
    NewSettings,
    Stored,
    decode_to_guard,
    encode_from_guard,
)

TOKENS = {"secret-one": "one", "secret-two": "two"}


class FakeController:
    """Says what to put in force, and remembers what it was told."""

    def __init__(self):
        self.hellos, self.answers = [], []
        self.settings = Settings(revision=1)
        self.refuse = None
        self.on_greet = lambda: None

    def handle_hello(self, robot, hello):
        found = self.settings
        self.hellos.append((robot, hello))
        self.on_greet()
        if self.refuse:
            raise self.refuse
        return found

    def handle_applied(self, robot, applied):
        self.answers.append((robot, applied))


class CollectorServer:
    """A collector behind a server in a thread."""

    def __init__(self, database, **patience):
        self.hub, self.controller, self.tokens = Hub(), FakeController(), dict(TOKENS)
        self.collector = DataCollector(
            signer=SIGNER,
            steady_clock=SteadyClock(time.time_ns, time.monotonic_ns),
            database=database,
            hub=self.hub,
            handshake=self.controller,
            authenticate=self.tokens.get,
            find_valid_tokens=lambda tokens: self.tokens.keys() & tokens,
            clock=time.time_ns,
            retention=RetentionLimits(),
            timeouts=ConnectionTimeouts(**patience),
        )
        self.tally = self.collector.counters
        self.port = 0

    @contextmanager
    def serving(self):
        """Serve until the end of the block."""
        app = FastAPI(lifespan=self._running)
        app.router.routes.extend(router.routes)
        app.state.collector = self.collector
        with serve_app(app, {**serving(ServiceConfig()), "host": "127.0.0.1"}) as self.port:
            yield self

    @asynccontextmanager
    async def _running(self, app):
        async with self.collector.running():
            yield

    def connect(self, token="secret-one", **options):
        """Connect as a guard's link process does."""
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        url = f"ws://127.0.0.1:{self.port}/link/v1"
        options = {
            "compression": None,
            "max_size": 1 << 24,
            "proxy": None,
            "open_timeout": LIMIT_S,
            **options,
        }
        return connect(url, additional_headers=headers, **options)

    @contextmanager
    def guard(self, token="secret-one", **values):
        """Give a guard that has said hello and has its settings."""
        with self.connect(token) as socket:
            send_message(socket, hello(**values))
            assert isinstance(receive_message(socket), NewSettings)
            yield socket


def hello(**values):
    """Make a guard's hello."""
    return Hello(
        **{"app": "app", "plan": Plan(app="app"), "run": "r", "began": 1, "version": "1"} | values
    )


def send_message(socket, message):
    """Send a message."""
    socket.send(encode_from_guard(message), text=True)


def receive_message(socket):
    """Receive a message."""
    return decode_to_guard(socket.recv(timeout=LIMIT_S))


def send_events(socket, events):
    """Send events; return up to which number they are stored."""
    send_message(socket, Events(events=tuple(events)))
    stored = receive_message(socket)
    assert isinstance(stored, Stored)
    return stored.run, stored.number
