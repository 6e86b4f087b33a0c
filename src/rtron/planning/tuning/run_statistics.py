"""What a run says about the nouns of a plan.

The rules of thumb, the same for every duration that waits for somebody:

- It must last: 1.5 times what 999 of 1000 took, 1.25 times what the longest took, and three times
  the usual, rounded up to a number that a person likes to read. So nothing that was measured would
  have been cut off.
- It is made longer if at least `min_samples` were measured and the need is above it.
- It is made shorter if at least `enough_samples` were measured, the need is a fifth below it or
  more, and nothing objects: other flows of which too little is known, for instance.
- A silence is never made longer than `MAX_SILENCE`: a robot that goes on for longer without a
  word is for a person to look at.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from rtron.planning.tuning.formatting import count_text, plan_duration, round_up, short_duration
from rtron.vocabulary import (
    SECOND,
    DurationStatistics,
    Flow,
    FlowStatistics,
    MeasuredRun,
    Mode,
    StreamStatistics,
    TuningProposal,
    TuningProposalKind,
)

MIN_SAMPLES, ENOUGH_SAMPLES = 20, 100
MIN_GOALS, ENOUGH_GOALS = 5, 20
MAX_SILENCE = 5 * SECOND
MAX_GOAL_DURATION = 24 * 3600 * SECOND
MIN_DURATION = SECOND // 10
_USUAL_FACTOR = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class FitBounds:
    """How many are few and enough, and the shortest and longest that may be proposed (ns)."""

    min_samples: int = MIN_SAMPLES
    enough_samples: int = ENOUGH_SAMPLES
    minimum: int = MIN_DURATION
    maximum: int = MAX_SILENCE


SILENCE_BOUNDS = FitBounds()
GOAL_BOUNDS = FitBounds(
    min_samples=MIN_GOALS, enough_samples=ENOUGH_GOALS, minimum=SECOND, maximum=MAX_GOAL_DURATION
)
WAIT_BOUNDS = FitBounds(maximum=MAX_GOAL_DURATION)


@dataclass(frozen=True, slots=True, kw_only=True)
class DurationFit:
    """What becomes of a duration, and why."""

    kind: TuningProposalKind
    after: int
    why: str


def required_duration(figures: DurationStatistics) -> int:
    """Return how long (ns) to wait so that nothing that was measured is cut off, with a margin."""
    return max(3 * figures.p999 // 2, 5 * figures.max // 4, _USUAL_FACTOR * figures.p50)


def fit_duration(
    before: int, measured: Sequence[DurationStatistics], bounds: FitBounds, *, objection: str = ""
) -> DurationFit:
    """Return what a duration becomes that must outlast all that was `measured`, by whom each.

    `objection` is what speaks against making it shorter.
    """
    known = [each for each in measured if each.count >= bounds.min_samples]
    if not known:
        return _unchanged(
            before, f"too little to say anything: at least {bounds.min_samples} are needed"
        )
    if before == 0:
        return _unchanged(before, "0 s was chosen")
    proposed = max(round_up(max(map(required_duration, known))), bounds.minimum)
    if proposed > before:
        return _lengthened(before, proposed, bounds)
    if 5 * proposed > 4 * before:
        return _unchanged(before, "it fits")
    if min(each.count for each in measured) < bounds.enough_samples:
        objection = f"{bounds.enough_samples} of each are needed"
    if objection:
        return _unchanged(before, f"not made shorter: {objection}")
    return DurationFit(kind=TuningProposalKind.CHANGE, after=proposed, why="")


def describe_durations(figures: DurationStatistics, what: str) -> str:
    """Return figures in words: `12 408 gaps, largest 0.31 s, p99.9 0.2 s, p50 0.1 s`."""
    counted = count_text(figures.count, what)
    if not figures.count:
        return f"no {what}s"
    quantiles = f"p99.9 {short_duration(figures.p999)}, p50 {short_duration(figures.p50)}"
    return f"{counted}, largest {short_duration(figures.max)}, {quantiles}"


def _lengthened(before: int, proposed: int, bounds: FitBounds) -> DurationFit:
    if proposed <= bounds.maximum:
        return DurationFit(kind=TuningProposalKind.CHANGE, after=proposed, why="")
    why = f"it would take {plan_duration(proposed)}, which is too long to go by itself"
    return DurationFit(kind=TuningProposalKind.LOOK, after=before, why=why)


def _unchanged(before: int, why: str) -> DurationFit:
    return DurationFit(kind=TuningProposalKind.KEEP, after=before, why=why)


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
