"""Two `rtron serve` on one PostgreSQL database, and guards that talk to either."""

import json
import time
from contextlib import ExitStack, contextmanager, suppress

import httpx
from controller_setup import hello, plan
from forked_service import ForkedService
from harness import LIMIT_S, free_port, wait_for
from service_app import TLS
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.service.store.accounts.tokens import TokenSpec, create_token
from rtron.vocabulary import Decision, EventKind, GuardEvent, GuardEventLevel, GuardState
from rtron.wire.common.link_protocol import (
    Applied,
    Events,
    NewSettings,
    StateReport,
    Stored,
    decode_to_guard,
    encode_from_guard,
)


class ReplicaProcess:
    """`rtron serve` on a port of its own."""

    def __init__(self, folder, url, name, *options):
        self._folder, self._database, self._options = folder, url, options
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.log = folder / f"{name}.log"
        self._starts = 0
        self.start()

    def start(self):
        """Start it, once more after it was killed."""
        self._starts += 1
        arguments = ["--port", self.port, "--database", self._database, *self._options]
        self.process = ForkedService(arguments, self._folder, self.log)

    def wait_ready(self):
        """Wait until it serves."""
        wait_for(self._is_ready, LIMIT_S, f"{self.log}")

    def kill(self):
        """End it without a word."""
        self.process.kill()
        self.process.wait(LIMIT_S)

    def stop(self):
        """End it in order."""
        self.process.terminate()
        self.process.wait(LIMIT_S)

    def _is_ready(self):
        """Tell whether it serves, and has told its database: then its start is over."""
        assert self.process.poll() is None, self.log.read_text()
        if self.log.read_text().count("\ndatabase: ") < self._starts:
            return False
        with suppress(httpx.HTTPError):
            return httpx.get(f"{self.url}/readyz/read", timeout=5, verify=TLS).status_code == 200


class Person:
    """A program with every right, which asks one replica."""

    def __init__(self, replica, secret):
        self.replica, self.secret = replica, secret
        self._client = httpx.Client(
            base_url=f"{replica.url}/api/v1",
            headers={"Authorization": f"Bearer {secret}"},
            timeout=LIMIT_S,
            verify=TLS,
        )

    def close(self):
        """Ask no more."""
        self._client.close()

    def ask(self, path, method="GET", **body):
        """Return the answer."""
        return self._client.request(method, path, json=body or None)

    def readiness(self, path="/readyz/read"):
        """Return the status of the replica's readiness."""
        return httpx.get(f"{self.replica.url}{path}", timeout=LIMIT_S, verify=TLS).status_code

    def robot(self, name):
        """Return a robot as this replica has it."""
        return self.ask(f"/robots/{name}").json()

    def stop(self, name, reason="a test"):
        """Stop a robot."""
        return self.ask(f"/robots/{name}/stop", "POST", reason=reason)

    @contextmanager
    def console(self, robot):
        """Listen to what is live of a robot; give a function that waits for a message."""
        url = f"ws://127.0.0.1:{self.replica.port}/api/v1/live"
        headers = {"Authorization": f"Bearer {self.secret}"}
        with connect(url, additional_headers=headers, proxy=None, open_timeout=LIMIT_S) as socket:
            socket.send(json.dumps({"robots": [robot], "events": False}))

            def receive(condition):
                while True:
                    message = json.loads(socket.recv(timeout=LIMIT_S))
                    if condition(message):
                        return message

            yield receive


class SimulatedGuard:
    """A guard of a robot, connected to a replica; it does nothing by itself."""

    def __init__(self, replica, robot, secret, **values):
        self.robot = robot
        self._stack = ExitStack()
        connecting = connect(
            f"ws://127.0.0.1:{replica.port}/link/v1",
            additional_headers={"Authorization": f"Bearer {secret}"},
            proxy=None,
            open_timeout=LIMIT_S,
        )
        self._socket = self._stack.enter_context(connecting)
        self.send(hello(plan(), **values))
        self.settings = self.receive(NewSettings).settings

    def send(self, message):
        """Send a message."""
        self._socket.send(encode_from_guard(message), text=True)

    def receive(self, kind):
        """Return the next message of a kind."""
        while True:
            message = decode_to_guard(self._socket.recv(timeout=LIMIT_S))
            if isinstance(message, kind):
                return message

    def receive_settings(self):
        """Take the next settings."""
        self.settings = self.receive(NewSettings).settings
        return self.settings

    def answer(self):
        """Say that the last settings are in force."""
        self.send(Applied(revision=self.settings.revision, error=""))

    def tell_state(self, **values):
        """Tell what it is at."""
        state = GuardState(**{"at": 1, "revision": self.settings.revision} | values)
        self.send(StateReport(state=state))

    def send_events(self, run, numbers):
        """Send events."""
        self.send(Events(events=tuple(make_event(run, number) for number in numbers)))

    def stored_number(self):
        """Return up to which number events are stored, once the service says so."""
        return self.receive(Stored).number

    def store_events(self, run, numbers):
        """Send events; return up to which number they are stored."""
        self.send_events(run, numbers)
        return self.stored_number()

    def close_code(self):
        """Wait until the service ends the connection; return the code."""
        with suppress(ConnectionClosed):
            while True:
                self._socket.recv(timeout=LIMIT_S)
        return self._socket.close_code

    def close(self):
        """Go."""
        self._stack.close()


def make_event(run, number):
    """Make an event that people must see."""
    return GuardEvent(
        run=run,
        number=number,
        at=number,
        kind=EventKind.VERDICT,
        level=GuardEventLevel.WARNING,
        decision=Decision.DROP,
        node="drive",
        reason=f"event {number}",
    )


def create_secret(database, name, *scopes, robot=None):
    """Make a token; return its secret."""
    with database.session() as session:
        spec = TokenSpec(name=name, scopes=scopes, robot=robot)
        return create_token(session, time.time_ns(), "test", spec)[1]
