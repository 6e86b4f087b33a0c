"""One stream, second by second: what became of its messages, and how long they took."""

from typing import TYPE_CHECKING, Any

from rtron.guard.core.lease_text import lease_status
from rtron.guard.core.stream import GuardedStream
from rtron.guard.measurement.histogram import LatencyStatistics
from rtron.vocabulary import StreamState, VerdictCounts

if TYPE_CHECKING:
    from collections.abc import Mapping

_NONE = VerdictCounts()


class StreamMonitor:
    """Counts between two calls of `figures`."""

    def __init__(self, guarded: GuardedStream) -> None:
        self.guarded = guarded
        self._delays = guarded.latencies = LatencyStatistics()
        self._former_tallies: Mapping[str, VerdictCounts] = {}
        self._former_lost = (0, 0)
        self._latency: tuple[float, float] | None = None

    def state(self, now: int) -> StreamState:
        """Return who controls the stream at `now` (ns, steady), and why."""
        guarded = self.guarded
        owner = guarded.pipeline.owner or ""
        publishers = {flow.name: flow.publisher for flow in guarded.spec.flows}
        return StreamState(
            topic=guarded.spec.topic,
            nodes=tuple(stage.id for stage in guarded.spec.stages),
            mode=guarded.spec.mode,
            owner=owner,
            publisher=publishers.get(owner, ""),
            stopping=guarded.stop_controller.reason,
            flows=self._tallies(),
            strangers=dict(guarded.strangers),
            speed=guarded.stop_controller.speed,
            limit=guarded.limit(now),
            latency=self._latency,
            lost_behind=sum(guarded.lost_behind.values()),
            lease=guarded.lease_text,
            lease_status=lease_status(guarded.lease, now) if guarded.lease else None,
        )

    def figures(self, now: int) -> dict[str, Any] | None:
        """Return what happened since the last call, as a `counts` event has it; None if nothing."""
        tallies, before = self._tallies(), self._former_tallies
        self._former_tallies, self._latency = tallies, self._delays.reset()
        flows = {
            name: _difference(tally, before.get(name, _NONE)) for name, tally in tallies.items()
        }
        active = {name: counts for name, counts in flows.items() if any(counts)}
        lost = self._lost_since()
        if not active and not any(lost):
            return None
        speed, limit = self.guarded.stop_controller.speed, self.guarded.limit(now)
        found = {"flows": active, "speed": speed, "limit": limit, "latency": self._latency}
        return {**found, "lost": lost} if any(lost) else found

    def _lost_since(self) -> list[int]:
        """Return how many messages were lost before and behind the guard since the last call."""
        lost = (
            sum(self.guarded.losses.before.values()),
            sum(self.guarded.lost_behind.values()),
        )
        before, self._former_lost = self._former_lost, lost
        return [new - old for new, old in zip(lost, before, strict=True)]

    def _tallies(self) -> dict[str, VerdictCounts]:
        lost = self.guarded.losses.before
        return {
            name: VerdictCounts(
                passed=each.passed,
                held=each.held,
                dropped=each.dropped,
                modified=each.modified,
                lost=lost.get(name, 0),
            )
            for name, each in self.guarded.pipeline.tallies.items()
        }


def _difference(now: VerdictCounts, before: VerdictCounts) -> list[int]:
    return [
        now.passed - before.passed,
        now.held - before.held,
        now.dropped - before.dropped,
        now.modified - before.modified,
    ]
