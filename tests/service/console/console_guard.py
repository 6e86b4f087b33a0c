"""A simulated guard: speaks `wire/link` to a running service, as a robot of its own would."""

import threading
from contextlib import ExitStack
from dataclasses import replace

from console_robot import Guard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.vocabulary import EventKind, effective_plan
from rtron.wire.common.link_protocol import (
    Applied,
    Events,
    Hello,
    NewSettings,
    State,
    guard_bytes,
    to_guard,
)


class LinkedGuard:
    """Tells its state twice a second and puts settings in force, or refuses them, when told to."""

    def __init__(self, port, headers, plan, every=0.5):
        self.guard = Guard(plan)
        self.answers, self.error = threading.Event(), ""
        self.answers.set()
        self.settings = []
        self._every, self._ends, self._lock = every, threading.Event(), threading.Lock()
        address = f"ws://127.0.0.1:{port}/link/v1"
        self._open = ExitStack()
        opening = connect(address, additional_headers=headers, max_size=None)
        self._socket = self._open.enter_context(opening)
        self.say(Hello(app=plan.app, plan=plan, run=self.guard.run, began=1, version="1"))
        self._threads = [
            threading.Thread(target=each, daemon=True) for each in (self._hear, self._tell)
        ]
        for thread in self._threads:
            thread.start()

    def say(self, message):
        with self._lock:
            self._socket.send(guard_bytes(message))

    def events(self, *events):
        """Send events."""
        self.say(Events(events=tuple(events)))

    def event(self, kind, **more):
        """Send one event."""
        self.events(self.guard.event(kind, **more))

    def attack(self):
        """A stranger speaks on /cmd_vel."""
        self.events(*self.guard.steal())
        self.tell()

    def tell(self):
        """Send the state now."""
        self.say(State(state=self.guard.state()))

    def close(self):
        self._ends.set()
        self.answers.set()
        self._open.close()
        for thread in self._threads:
            thread.join(10)

    def _tell(self):
        before = self.guard.state()
        while not self._ends.wait(self._every):
            now = self.guard.state()
            try:
                self.events(*self.guard.happened(before, now))
                self.say(State(state=now))
            except ConnectionClosed:
                return
            before = now

    def _hear(self):
        try:
            for frame in self._socket:
                message = to_guard(frame)
                if isinstance(message, NewSettings):
                    self._apply(message.settings)
        except ConnectionClosed:
            return

    def _apply(self, settings):
        self.settings.append(settings)
        self.answers.wait()
        if self._ends.is_set():
            return
        if not self.error:
            self.guard.revision = settings.revision
            self.guard.stopped = settings.stop is not None
            in_force = effective_plan(self.guard.plan, settings).rsrcn
            self.guard.limit = in_force.max_vel_limit if in_force else 0.22
            self.guard.overridden = tuple(settings.overrides)
        self.say(Applied(revision=settings.revision, error=self.error))
        reason = self.error or f"revision {settings.revision} is in force"
        self.event(EventKind.SETTINGS, reason=reason, revision=settings.revision)
        self.tell()


def hostile(plan, name):
    """Return a plan in which every publisher and topic has a name that a browser might run."""
    grcn = plan.grcn[0]
    flows = tuple(replace(flow, publisher=f"/{name}{flow.name}") for flow in grcn.flows)
    return replace(plan, grcn=(replace(grcn, flows=flows), *plan.grcn[1:]))
