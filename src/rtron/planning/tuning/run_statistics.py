"""What a run says about the nouns of a plan."""

from collections.abc import Callable
from dataclasses import dataclass, field

from rtron.planning.tuning.duration_fit import Settled
from rtron.planning.tuning.formatting import written
from rtron.vocabulary import (
    Flow,
    FlowFigures,
    Mode,
    Proposal,
    Run,
    StreamFigures,
)

Note = Callable[[Proposal], None]
"""Takes a proposal."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Finds the figures of a stream; those of other publishers than the plan's do not count."""

    run: Run
    _streams: dict[tuple[str, Mode], StreamFigures] = field(default_factory=dict)

    @classmethod
    def of(cls, run: Run) -> "Measured":
        """Return what a run says."""
        return cls(run, {(stream.topic, stream.mode): stream for stream in run.streams})

    def stream(self, topic: str, mode: Mode) -> StreamFigures | None:
        """Return what was measured on a topic; None if nothing was."""
        return self._streams.get((topic, mode))


def of_flow(stream: StreamFigures, flow: Flow) -> FlowFigures:
    """Return what a flow did: nothing, if another publisher had its name in that run."""
    for each in stream.flows:
        if (each.flow, each.publisher) == (flow.name, flow.publisher):
            return each
    return FlowFigures(flow=flow.name, publisher=flow.publisher)


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A value of a plan: the coordination node's id, the flow if it is one's, and the key."""

    node: str
    key: str
    flow: str = ""

    def settled(self, before: int, found: Settled, figures: str, samples: int) -> Proposal:
        """Return the proposal about a duration."""
        return Proposal(
            kind=found.kind,
            node=self.node,
            flow=self.flow,
            key=self.key,
            before=written(before),
            after=written(found.after),
            why="; ".join(filter(None, (figures, found.why))),
            samples=samples,
        )
