"""The host: every coordination node of a plan in one process, and what they tell the world."""

import logging
import time
from collections.abc import Sequence
from functools import partial

from rtron.guard.guarded import GuardedStream
from rtron.guard.messages import (
    DIAGNOSTICS,
    ERROR,
    OK,
    STRING,
    WARN,
    Status,
    diagnostics_message,
    string_message,
)
from rtron.guard.transport.transport import Output, Transport
from rtron.vocabulary import SECOND, Stream

log = logging.getLogger(__name__)

GUARD_NODE = "/rtron_guard"
_IDLE = "idle"


class Host:
    """Opens the streams on a transport and reports: `~active` on change, `/diagnostics` at 1 Hz."""

    def __init__(self, transport: Transport, streams: Sequence[Stream]) -> None:
        self.guarded = [GuardedStream(stream, transport) for stream in streams]
        self._transport = transport
        self._diagnostics: Output | None = None
        self._reports = 0

    def open(self) -> None:
        """Join the graph with every coordination node."""
        for guarded in self.guarded:
            guarded.open()
            self._show_owner(guarded)
        self._diagnostics = self._announce(GUARD_NODE, "/diagnostics", DIAGNOSTICS.type)
        self._diagnostics.learn(DIAGNOSTICS)
        self._report()

    def killed(self, node: str, reason: str) -> bool:
        """Shut what a killed node took part in; tell whether it was the guard's own node."""
        for guarded in self.guarded:
            if node in guarded.nodes:
                guarded.shut(f"{node} was shut down, {reason}")
        return node == GUARD_NODE

    def statuses(self) -> list[Status]:
        """Return the state of every stream."""
        return [_status(guarded) for guarded in self.guarded]

    def _announce(self, node: str, topic: str, type: str) -> Output:
        return self._transport.advertise(node, topic, type)

    def _show_owner(self, guarded: GuardedStream) -> None:
        name = guarded.stream.topic.strip("/").replace("/", "_")
        topic = f"{guarded.nodes[0]}/{name}/active"
        active = self._announce(guarded.nodes[0], topic, STRING.type)
        active.learn(STRING)
        guarded.owner_changed = partial(_tell, guarded, active)
        guarded.owner_changed(None)

    def _report(self) -> None:
        if self._diagnostics is not None:
            self._reports += 1
            message = diagnostics_message(self._reports, time.time_ns(), self.statuses())
            self._diagnostics.publish(message)
        self._transport.call_at(self._transport.now() + SECOND, self._report)


def _tell(guarded: GuardedStream, active: Output, owner: str | None) -> None:
    publishers = {flow.name: flow.publisher for flow in guarded.stream.flows}
    text = f"{owner} {publishers.get(owner, '')}".strip() if owner else _IDLE
    log.info("%s: %s", guarded.stream.topic, text)
    active.publish(string_message(text), latched_by=GUARD_NODE)


def _status(guarded: GuardedStream) -> Status:
    stream, pipeline = guarded.stream, guarded.pipeline
    values = {
        flow: f"passed {tally.passed}, held {tally.held}, dropped {tally.dropped}"
        + (f"; {tally.last.reason}" if tally.last else "")
        for flow, tally in pipeline.tallies.items()
    }
    values |= {f"unapproved {node}": f"connected {n}" for node, n in guarded.strangers.items()}
    level, message = OK, f"{pipeline.owner or _IDLE}"
    if guarded.strangers:
        level, message = WARN, f"unapproved publishers: {', '.join(guarded.strangers)}"
    if pipeline.closed:
        level, message = ERROR, pipeline.closed
    name = f"rtron: {stream.topic} ({', '.join(stage.id for stage in stream.stages)})"
    return Status(level, name, message, values)
