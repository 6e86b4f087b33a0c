"""A simulated guard: speaks `wire/link` to a running service, as a robot of its own would."""

import threading
from contextlib import ExitStack
from dataclasses import replace

from console_robot import GuardModel
from harness import LIMIT_S
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.coherence import EffectivePlan
from rtron.vocabulary import EventKind
from rtron.wire.common.link_protocol import (
    Applied,
    Events,
    Hello,
    NewSettings,
    StateReport,
    decode_to_guard,
    encode_from_guard,
)


class SimulatedGuard:
    """Tells its state twice a second and puts settings in force, or refuses them, when told to."""

    def __init__(self, port, headers, plan, every=0.5):
        self.guard = GuardModel(plan)
        self.answers, self.error = threading.Event(), ""
        self.answers.set()
        self.settings = []
        self._interval, self._stopping, self._lock = every, threading.Event(), threading.Lock()
        address = f"ws://127.0.0.1:{port}/link/v1"
        self._open = ExitStack()
        opening = connect(address, additional_headers=headers, max_size=None, open_timeout=LIMIT_S)
        self._socket = self._open.enter_context(opening)
        self.send(Hello(app=plan.app, plan=plan, run=self.guard.run, began=1, version="1"))
        self._threads = [
            threading.Thread(target=each, daemon=True)
            for each in (self._receive, self._send_states)
        ]
        for thread in self._threads:
            thread.start()

    def send(self, message):
        with self._lock:
            self._socket.send(encode_from_guard(message))

    def events(self, *events):
        """Send events."""
        self.send(Events(events=tuple(events)))

    def event(self, kind, **more):
        """Send one event."""
        self.events(self.guard.event(kind, **more))

    def attack(self):
        """A stranger speaks on /cmd_vel."""
        self.events(*self.guard.attack_events())
        self.send_state()

    def send_state(self):
        """Send the state now."""
        self.send(StateReport(state=self.guard.state()))

    def close(self):
        self._stopping.set()
        self.answers.set()
        self._open.close()
        for thread in self._threads:
            thread.join(60)

    def _send_states(self):
        before = self.guard.state()
        while not self._stopping.wait(self._interval):
            now = self.guard.state()
            try:
                self.events(*self.guard.events_between(before, now))
                self.send(StateReport(state=now))
            except ConnectionClosed:
                return
            before = now

    def _receive(self):
        try:
            for frame in self._socket:
                message = decode_to_guard(frame)
                if isinstance(message, NewSettings):
                    self._apply(message.settings)
        except ConnectionClosed:
            return

    def _apply(self, settings):
        self.settings.append(settings)
        self.answers.wait()
        if self._stopping.is_set():
            return
        if not self.error:
            self.guard.revision = settings.revision
            self.guard.stopped = settings.stop is not None
            in_force = EffectivePlan(self.guard.plan, settings).plan.rsrcn
            self.guard.limit = in_force.max_vel_limit if in_force else 0.22
            self.guard.overridden = tuple(settings.overrides)
        self.send(Applied(revision=settings.revision, error=self.error))
        reason = self.error or f"revision {settings.revision} is in force"
        self.event(EventKind.SETTINGS, reason=reason, revision=settings.revision)
        self.send_state()


def hostile_plan(plan, name):
    """Return a plan in which every publisher and topic has a name that a browser might run."""
    grcn = plan.grcn[0]
    flows = tuple(replace(flow, publisher=f"/{name}{flow.name}") for flow in grcn.flows)
    return replace(plan, grcn=(replace(grcn, flows=flows), *plan.grcn[1:]))
