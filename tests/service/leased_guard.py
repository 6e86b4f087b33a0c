"""A guard in memory with a leased base, connected to a service: its leases are the real ones."""

import threading
import time
from contextlib import ExitStack, suppress
from dataclasses import replace

from harness import LIMIT_S
from leased_base import PLAN, TTL, LeasedBase
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.guard.authority.service_leases import ServiceLeases
from rtron.guard.core.lease_text import lease_status
from rtron.vocabulary import CommanderRank, GuardEvent, GuardState, LeaseGroup, Mode, StreamState
from rtron.wire.common.link_protocol import (
    ApprovalCommand,
    Events,
    Hello,
    LeaseCommand,
    StateReport,
    decode_to_guard,
    encode_from_guard,
)

REMOTE = CommanderRank.REMOTE_OPERATOR
SERVED_PLAN = replace(PLAN, leases=(LeaseGroup(name="base", ttl=TTL, service=REMOTE),))


class LeasedGuard:
    """Carries out what people ask of its leases, and tells its state after each command."""

    def __init__(self, port, headers, plan=SERVED_PLAN, every=None, **hello):
        """Tell the state each `every` seconds, too."""
        self.base = LeasedBase(plan)
        self.commands = []
        self._number = 0
        self._lock = threading.Lock()
        self.answer = ServiceLeases(self.base.controller, self.record).carry_out
        """Makes the response to a command; None: there is none."""
        self._stack = ExitStack()
        address = f"ws://127.0.0.1:{port}/link/v1"
        opening = connect(address, additional_headers=headers, proxy=None, open_timeout=LIMIT_S)
        self._socket = self._stack.enter_context(opening)
        hello = {"takes_lease_commands": True} | hello
        self.send(Hello(app=plan.app, plan=plan, run="run", began=1, version="1", **hello))
        self.tell_state()
        self._closing = threading.Event()
        parts = [self._receive, *([lambda: self._speak(every)] if every else [])]
        self._threads = [threading.Thread(target=part, daemon=True) for part in parts]
        for thread in self._threads:
            thread.start()

    def send(self, message):
        with self._lock:
            self._socket.send(encode_from_guard(message), text=True)

    def held(self):
        base = self.base
        return lease_status(base.controller.leases["base"], base.transport.now())

    def ask(self, who, text):
        """Let a node of the robot ask for the lease."""
        self.base.ask(who, text)
        self.tell_state()

    def tell_state(self):
        nodes = {"nodes": ("grcn_cmd_vel",), "mode": Mode.ENFORCE}
        stream = StreamState(topic="/cmd_vel", lease_status=self.held(), **nodes)
        state = GuardState(
            at=time.time_ns(), revision=0, streams=(stream,), requests=self.requests()
        )
        self.send(StateReport(state=state))

    def requests(self):
        """Return what waits at the bridge of the robot, which has none."""
        return

    def record(self, kind, level=None, **values):
        self._number += 1
        now = time.time_ns()
        event = GuardEvent(run="run", number=self._number, at=now, kind=kind, **values)
        self.send(Events(events=(event,)))

    def close(self):
        self._closing.set()
        self._stack.close()
        for thread in self._threads:
            thread.join(LIMIT_S)

    def _speak(self, every):
        with suppress(ConnectionClosed):
            while not self._closing.wait(every):
                self.tell_state()

    def _receive(self):
        with suppress(ConnectionClosed):
            for frame in self._socket:
                message = decode_to_guard(frame)
                if isinstance(message, LeaseCommand | ApprovalCommand):
                    self._carry_out(message)

    def _carry_out(self, command):
        self.commands.append(command)
        if self.answer:
            self.send(self.answer(command))
            self.tell_state()
