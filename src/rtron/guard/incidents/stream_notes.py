"""What happens in one process of the guard, noted for the recorder of incidents."""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.incidents.entries import (
    LONGEST_MESSAGE,
    Entry,
    EntryBuffer,
    EventMessage,
    LeaseAnswered,
    Observed,
    RuleSwitched,
)
from rtron.guard.incidents.stream_tap import StreamTap
from rtron.guard.transport.common.protocol import Peer
from rtron.policies.authority.command_lease import LeaseAnswer
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import SECOND, Mode

if TYPE_CHECKING:
    from rtron.guard.coordinator import Coordinator
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.core.observations import Observations
    from rtron.guard.lanes.command.bulk_connection import BulkConnection

_SAMPLE_PERIOD = SECOND // 10
MAX_WAITING_BYTES = 1 << 20
"""What may wait for a bulk process, bytes: some seconds of a robot that is driven."""
BATCH_BYTES = 1 << 15
"""What is sent at once, so that a command waits for some 100 entries at most, bytes."""
_SEND_PERIOD = SECOND // 50


def observed_state(observations: "Observations", now: int) -> Observed:
    """Return the frame rates and the events as they are at `now` (ns)."""
    rates = ((id, monitor.rate(now)) for id, monitor in observations.rates.monitors.items())
    bits = observations.mission.bits.by_name
    return Observed(
        now,
        tuple((id, each.fps, 0 if each.age is None else now - each.age) for id, each in rates),
        tuple((name, *bit.state) for name, bit in bits.items()),
    )


class StreamNotes:
    """Notes what happens to the streams and rules of a host, from `open` on."""

    def __init__(self, host: "Coordinator", now: Callable[[], int], max_bytes: int) -> None:
        """`max_bytes` may wait."""
        self.buffer = EntryBuffer(max_bytes)
        self._host = host
        self._now = now
        self._taps: list[StreamTap] = []
        self._sampled_at = 0

    def open(self) -> None:
        """Listen to the streams that are enforced, to rules and leases."""
        for guarded in self._host.streams:
            if guarded.spec.mode is not Mode.ENFORCE:
                continue
            guarded.tap = StreamTap(guarded, self.buffer)
            self._taps.append(guarded.tap)
        self._host.follow_events(self._note_event)
        mission = self._host.observations.mission
        mission.on_change = partial(self._note_rule, mission.on_change)
        self._host.on_lease_answer = self._note_lease

    def take(self, max_bytes: int) -> list[Entry]:
        """Return about `max_bytes` of what was noted, types first."""
        now = self._now()
        if now - self._sampled_at >= _SAMPLE_PERIOD:
            self._sampled_at = now
            for tap in self._taps:
                tap.sample(now)
        types = [learned for tap in self._taps if (learned := tap.new_type())]
        return [*types, *self.buffer.take(max_bytes, now)]

    def forget(self) -> None:
        """Note types and states once more, for a recorder that has just begun."""
        for tap in self._taps:
            tap.forget()

    def _note_event(self, topic: str, peer: Peer, message: bytes) -> None:
        if len(message) <= LONGEST_MESSAGE:
            info = peer.info
            what = (topic, peer.node, info.type, info.md5sum, info.definition, message)
            self.buffer.add(EventMessage(self._now(), *what), len(message))

    def _note_lease(self, lease: str, request: str, answer: LeaseAnswer) -> None:
        self.buffer.add(LeaseAnswered(self._now(), lease, request, answer.granted, answer.reason))

    def _note_rule(self, former: Callable[[RuleStatus], None], status: RuleStatus) -> None:
        former(status)
        rule, blocks = status.rule.name, status.is_blocking
        self.buffer.add(RuleSwitched(self._now(), rule, blocks, status.reason))


class IncidentNotes:
    """The command process's notes: sent to the bulk process, 50 times a second.

    They go over the connection that carries events, some at a time, and only while nothing else
    waits there.
    """

    def __init__(
        self, connection: "BulkConnection", host: "Coordinator", loop: "EventLoop"
    ) -> None:
        self._connection = connection
        self._loop = loop
        self._notes = StreamNotes(host, loop.now, MAX_WAITING_BYTES)
        connection.connect_listeners.append(self._notes.forget)

    def open(self) -> None:
        """Note and send from now on."""
        self._notes.open()
        self._send()

    def close(self) -> None:
        """Send what is left, as far as it goes at once."""
        self._send_batch()

    def _send(self) -> None:
        self._loop.call_at(self._loop.now() + _SEND_PERIOD, self._send)
        self._send_batch()

    def _send_batch(self) -> None:
        if self._connection.is_ready and (entries := self._notes.take(BATCH_BYTES)):
            self._connection.call("note_entries", tuple(entries))
