"""What the tests of the link share: events, a guard's end and a service's end that we control."""

import asyncio
import contextlib
import threading
from dataclasses import dataclass, field

from harness import wait_for
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import serve

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.link_client import LinkClient
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.relay import Relay
from rtron.vocabulary import EventKind, GuardEvent, GuardState, Plan, Settings
from rtron.wire.common.link_protocol import (
    Events,
    Hello,
    StateReport,
    Stored,
    decode_from_guard,
    encode_event,
    encode_to_guard,
)

TOKEN = "rtron_secret"


def event(number, run="run", kind=EventKind.VERDICT, **values):
    return GuardEvent(run=run, number=number, at=number, kind=kind, **values)


def encoded_events(*events):
    return [(each, encode_event(each)) for each in events]


def hello(run="run", **values):
    return Hello(app="app", plan=Plan(app="app"), run=run, began=1, version="1", **values)


def options(folder, service="http://127.0.0.1:1"):
    token = folder / "token"
    token.write_text(TOKEN + "\n")
    made = LinkOptions(service=service, token_file=token, robot="r1", state=folder / "state")
    made.prepare()
    return made


class Guard:
    """A guard's end in a loop of its own, turned by whoever waits."""

    def __init__(self, made, run="run", revision=0):
        self.loop = EventLoop()
        self.run, self.revision = run, revision
        self.settings = []
        self.line = LinkClient(
            self.loop, made.address, self.greeting, self.state, self.settings.append
        )
        self.line.open()

    def greeting(self):
        return hello(self.run, settings=Settings(revision=self.revision))

    def state(self):
        return StateReport(state=GuardState(at=1, revision=self.revision))

    def until(self, condition, what):
        def turned():
            self.loop.step(0.01)
            return condition()

        wait_for(turned, what=what)

    def close(self):
        self.line.close()
        self.loop.close()


@dataclass
class Service:
    """A service that we control: what it hears, and whether it confirms."""

    confirms: bool = True
    heard: list = field(default_factory=list)
    headers: list = field(default_factory=list)
    socket: object = None
    port: int = 0

    @property
    def url(self):
        return f"http://127.0.0.1:{self.port}"

    def events(self):
        return [each for m in self.heard if isinstance(m, Events) for each in m.events]

    def of(self, kind):
        return [message for message in self.heard if isinstance(message, kind)]

    def say(self, message):
        self.socket.send(encode_to_guard(message).decode())

    def serve(self, socket):
        self.socket = socket
        self.headers.append(socket.request.headers["Authorization"])
        with contextlib.suppress(ConnectionClosed):
            self._hear(socket)

    def _hear(self, socket):
        for frame in socket:
            message = decode_from_guard(frame)
            self.heard.append(message)
            if isinstance(message, Events) and self.confirms:
                last = message.events[-1]
                self.say(Stored(run=last.run, number=last.number))


@contextlib.contextmanager
def serving(service):
    """Serve on a free port, or on the one the service had before."""
    with serve(service.serve, "127.0.0.1", service.port) as server:
        service.port = server.socket.getsockname()[1]
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield service
        finally:
            if service.socket:
                service.socket.close_socket()
            server.shutdown()
            thread.join()


@contextlib.contextmanager
def running_relay(made):
    """Run a link process's relay in a thread of its own; `call` calls something there."""
    started, found = threading.Event(), []

    async def run():
        ended = asyncio.Event()
        found.extend([Relay(made), asyncio.get_running_loop(), ended])
        started.set()
        await found[0].run(ended)

    thread = threading.Thread(target=asyncio.run, args=[run()])
    thread.start()
    assert started.wait(60)
    relay, loop, ended = found
    relay.call = loop.call_soon_threadsafe
    try:
        yield relay
    finally:
        with contextlib.suppress(RuntimeError):
            loop.call_soon_threadsafe(ended.set)
        thread.join(60)
        assert not thread.is_alive()
