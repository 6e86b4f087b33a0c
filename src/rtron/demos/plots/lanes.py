"""What the guard decided, flow by flow, in the time of a run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtron.demos.metrics.case_run import CaseRun
from rtron.demos.metrics.guard_events import DECISIONS, SECOND, SecondCounts, decision_counts
from rtron.vocabulary import UNAPPROVED

DECISION_LABELS = {"pass": "passed", "hold": "held", "drop": "dropped", "modify": "changed"}


@dataclass(frozen=True, slots=True)
class FlowLane:
    """A flow: for each counted time, when it began (simulated s) and how often which decision."""

    topic: str
    publisher: str
    bars: Sequence[tuple[float, Mapping[str, int]]]

    @property
    def totals(self) -> str:
        """How many messages met which decision, in words."""
        sums = {name: sum(counts[name] for _, counts in self.bars) for name in DECISIONS}
        return ", ".join(
            f"{count} {DECISION_LABELS[name]}" for name, count in sums.items() if count
        )

    @property
    def busiest(self) -> int:
        """How many messages came in the busiest of the counted times."""
        return max(sum(counts.values()) for _, counts in self.bars)


def flow_lanes(run: CaseRun, topics: Sequence[str]) -> tuple[FlowLane, ...]:
    """Return the flows of some topics that spoke in a run, in the order of topics and names."""
    counted = [each for each in decision_counts(run.events) if each.topic in topics]
    found: dict[tuple[str, str], list[SecondCounts]] = {}
    for each in counted:
        found.setdefault((each.topic, each.flow), []).append(each)
    known = {**run.publishers, **{(topic, UNAPPROVED): "whoever else" for topic in topics}}
    ordered = sorted(found, key=lambda key: (topics.index(key[0]), known.get(key, "~")))
    return tuple(
        FlowLane(
            key[0],
            known.get(key, key[1]),
            [(_second_start(run, e.at), e.counts) for e in found[key]],
        )
        for key in ordered
        if any(any(each.counts.values()) for each in found[key])
    )


def _second_start(run: CaseRun, at: int) -> float:
    """Return when (simulated s of the run) the wall second began that ends at `at` (wall ns)."""
    return (at / SECOND - 1 - run.start_wall) * run.speed
