"""Whether the robot's drivers take the commands that they are sent, each connection by itself.

A connection that is silent says nothing, and one that is slow but moves is in order. A node that
takes nothing while messages wait for it is frozen, or its network is gone.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from rtron.guard.core.alarms import Alarms
from rtron.guard.transport.common.protocol import LiveTransport, SubscriberProgress
from rtron.vocabulary import (
    SECOND,
    Alarm,
    AlarmKind,
    Mode,
    Stream,
    flow_topic,
    matches_node,
    output_topic,
)

_LONGEST_PERIOD = SECOND // 4


@dataclass(slots=True)
class _Connection:
    """How much a subscriber has taken at most, how long (ns) no more, and the alarm for that."""

    alarm: Alarm
    taken: int = -1
    silence: int = 0

    def update(self, progress: SubscriberProgress, elapsed: int) -> None:
        """Take what is seen after `elapsed` ns; what is not known changes nothing."""
        if progress.taken is None:
            return
        is_stuck = progress.is_awaited and progress.taken <= self.taken
        self.silence = self.silence + elapsed if is_stuck else 0
        self.taken = max(self.taken, progress.taken)


class OutputWatch:
    """Raises an alarm for each successor that takes nothing for `bound` (ns).

    It looks four times as often, and never while a message is on its way. Where the looks are late,
    so may be the successor: it gets as much longer, at most twice the time.
    """

    def __init__(
        self,
        streams: Iterable[Stream],
        alarms: Alarms,
        transport: LiveTransport,
        bound: int,
    ) -> None:
        self._topics = [
            (spec, topic)
            for spec in streams
            if spec.mode is Mode.ENFORCE
            for topic in _topics_of_successors(spec)
        ]
        self._alarms = alarms
        self._transport = transport
        self._bound = bound
        self._period = min(bound // 4, _LONGEST_PERIOD)
        self._connections: dict[tuple[str, str], _Connection] = {}
        self._looked_at = 0
        self._late = 0

    def open(self) -> None:
        """Look from now on."""
        self._looked_at = self._transport.now()
        self._transport.call_at(self._looked_at + self._period, self._look)

    def close(self) -> None:
        """Look no more; the timers end with the loop."""

    def _look(self) -> None:
        now = self._transport.now()
        self._transport.call_at(now + self._period, self._look)
        since, self._looked_at = now - self._looked_at, now
        self._late = max(since - self._period, self._late // 2)
        found = {
            (topic, progress.address): (spec, progress)
            for spec, topic in self._topics
            for progress in self._transport.subscriber_progress(topic)
            if any(matches_node(successor, progress.node) for successor in spec.successors)
        }
        self._forget(self._connections.keys() - found.keys())
        for key, (spec, progress) in found.items():
            self._check(key, spec, progress, min(since, 2 * self._period))

    def _check(
        self, key: tuple[str, str], spec: Stream, progress: SubscriberProgress, elapsed: int
    ) -> None:
        connection = self._connections.setdefault(key, _Connection(_alarm(spec, key, progress)))
        connection.update(progress, elapsed)
        if not connection.silence:
            self._alarms.clear(connection.alarm)
        elif connection.silence >= self._bound + min(3 * self._late, self._bound):
            self._alarms.raise_(connection.alarm, self._looked_at)

    def _forget(self, gone: Iterable[tuple[str, str]]) -> None:
        for key in gone:
            self._alarms.clear(self._connections.pop(key).alarm)


def _topics_of_successors(spec: Stream) -> list[str]:
    """Return the private topics that successors subscribe to; see `StreamOutputs`."""
    mirrored = [
        flow_topic(spec.topic, flow.name)
        for flow in spec.flows
        if any(matches_node(flow.publisher, node) for node in spec.successors)
    ]
    return [output_topic(spec.topic), *mirrored]


def _alarm(spec: Stream, key: tuple[str, str], progress: SubscriberProgress) -> Alarm:
    topic, address = key
    reason = (
        f"{progress.node} takes nothing of what is sent to it on {topic}: it is frozen, or the "
        "network to it is gone; restart it, or look at its machine and the network"
    )
    return Alarm(
        kind=AlarmKind.UNDELIVERED,
        reason=reason,
        topic=spec.topic,
        node=progress.node,
        peer=address,
    )
