"""One stream, second by second: what became of its messages, and how long they took."""

from typing import TYPE_CHECKING, Any

from rtron.guard.core.stream import GuardedStream
from rtron.guard.delays import Delays
from rtron.vocabulary import FlowTally, StreamState

if TYPE_CHECKING:
    from collections.abc import Mapping

_NONE = FlowTally()


class StreamWatch:
    """Counts between two calls of `figures`."""

    def __init__(self, guarded: GuardedStream) -> None:
        self.guarded = guarded
        self._delays = guarded.delays = Delays()
        self._before: Mapping[str, FlowTally] = {}
        self._latency: tuple[float, float] | None = None

    def state(self, now: int) -> StreamState:
        """Return who controls the stream at `now` (ns, steady), and why."""
        guarded = self.guarded
        owner = guarded.pipeline.owner or ""
        publishers = {flow.name: flow.publisher for flow in guarded.stream.flows}
        return StreamState(
            topic=guarded.stream.topic,
            nodes=tuple(stage.id for stage in guarded.stream.stages),
            mode=guarded.stream.mode,
            owner=owner,
            publisher=publishers.get(owner, ""),
            stopping=guarded.stopper.why,
            flows=self._tallies(),
            strangers=dict(guarded.strangers),
            speed=guarded.stopper.speed,
            limit=_limit(guarded, now),
            latency=self._latency,
        )

    def figures(self, now: int) -> dict[str, Any] | None:
        """Return what happened since the last call, as a `counts` event has it; None if nothing."""
        tallies, before = self._tallies(), self._before
        self._before, self._latency = tallies, self._delays.take()
        flows = {name: _more(tally, before.get(name, _NONE)) for name, tally in tallies.items()}
        spoken = {name: counts for name, counts in flows.items() if any(counts)}
        if not spoken:
            return None
        speed, limit = self.guarded.stopper.speed, _limit(self.guarded, now)
        return {"flows": spoken, "speed": speed, "limit": limit, "latency": self._latency}

    def _tallies(self) -> dict[str, FlowTally]:
        return {
            name: FlowTally(
                passed=each.passed, held=each.held, dropped=each.dropped, modified=each.modified
            )
            for name, each in self.guarded.pipeline.tallies.items()
        }


def _more(now: FlowTally, before: FlowTally) -> list[int]:
    return [
        now.passed - before.passed,
        now.held - before.held,
        now.dropped - before.dropped,
        now.modified - before.modified,
    ]


def _limit(guarded: GuardedStream, now: int) -> float | None:
    limits = (policy.limit(now) for policy in guarded.overridable.values())
    return min((limit for limit in limits if limit is not None), default=None)
