"""What a run says about the nouns of a plan."""

from collections.abc import Callable
from dataclasses import dataclass, field

from rtron.planning.tuning.duration_fit import DurationFit
from rtron.planning.tuning.formatting import plan_duration
from rtron.vocabulary import (
    Flow,
    FlowStatistics,
    MeasuredRun,
    Mode,
    StreamStatistics,
    TuningProposal,
)

AddProposal = Callable[[TuningProposal], None]
"""Takes a proposal."""


@dataclass(frozen=True, slots=True)
class RunStatistics:
    """Finds the figures of a stream; those of other publishers than the plan's do not count."""

    run: MeasuredRun
    _streams: dict[tuple[str, Mode], StreamStatistics] = field(default_factory=dict)

    @classmethod
    def from_run(cls, run: MeasuredRun) -> "RunStatistics":
        """Return what a run says."""
        return cls(run, {(stream.topic, stream.mode): stream for stream in run.streams})

    def stream(self, topic: str, mode: Mode) -> StreamStatistics | None:
        """Return what was measured on a topic; None if nothing was."""
        return self._streams.get((topic, mode))


def flow_statistics(stream: StreamStatistics, flow: Flow) -> FlowStatistics:
    """Return what a flow did: nothing, if another publisher had its name in that run."""
    for each in stream.flows:
        if (each.flow, each.publisher) == (flow.name, flow.publisher):
            return each
    return FlowStatistics(flow=flow.name, publisher=flow.publisher)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanKey:
    """A value of a plan: the coordination node's id, the flow if it is one's, and the key."""

    node: str
    key: str
    flow: str = ""

    def proposal(self, before: int, fit: DurationFit, figures: str, samples: int) -> TuningProposal:
        """Return the proposal about a duration."""
        return TuningProposal(
            kind=fit.kind,
            node=self.node,
            flow=self.flow,
            key=self.key,
            before=plan_duration(before),
            after=plan_duration(fit.after),
            why="; ".join(filter(None, (figures, fit.why))),
            samples=samples,
        )
