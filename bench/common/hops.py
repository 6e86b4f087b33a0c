"""What a way adds to the latency of no way at all, beside what its peers add, in interleaved runs.

A statistic is taken of each run; a figure is the median over the runs, with their range. Its ratio
is the median of the runs' own ratios, so that what disturbs one run disturbs both sides of it.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from bench.common.latency import median, p99
from bench.common.pubsub import Load, LoadResult, Route, interleave
from bench.common.spinning import spinning
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import RUNS
from figures.figure import Figure

MACHINES = {"idle": 0, "busy": max(1, (os.cpu_count() or 1) - 1)}
"""How many processes spin beside the runs."""
_STATISTICS = {"median": median, "p99": p99}


@dataclass(frozen=True, slots=True)
class Peer:
    """A way beside ours, and the highest ratios of what ours adds to the `median` and the `p99`."""

    route: Route
    bounds: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Hop:
    """A load that goes over the ways in turn; `direct` is the way with nothing in between."""

    name: str
    load: Load
    direct: Route
    ours: Route
    peers: Sequence[Peer]

    @property
    def routes(self) -> list[Route]:
        """Return all ways."""
        return [self.direct, self.ours, *(peer.route for peer in self.peers)]


def figures_of(testbed: Testbed, hop: Hop, progress: ReportProgress) -> Iterator[Figure]:
    """Yield what is added on an idle and on a busy machine, and what is lost."""
    for machine, processes in MACHINES.items():
        name = f"{hop.name}.{machine}"
        progress(name)
        with spinning(testbed, processes):
            runs = interleave(testbed, hop.routes, hop.load, RUNS, progress)
        for peer in hop.peers:
            yield from _added(name, runs, hop, peer)
        lost = [sum(run.lost for run in runs[route.name]) for route in hop.routes[1:]]
        unit = f"messages of {RUNS * hop.load.count}"
        yield Figure(f"{name}.lost", lost[0], lost[1], unit, at_most=0)


def added(runs: Sequence[LoadResult], direct: Sequence[LoadResult], statistic: str) -> list[float]:
    """Return what each run has more than the direct one beside it, us."""
    of = _STATISTICS[statistic]
    return [of([run]) - of([none]) for run, none in zip(runs, direct, strict=True)]


def _added(
    name: str, runs: Mapping[str, Sequence[LoadResult]], hop: Hop, peer: Peer
) -> Iterator[Figure]:
    for statistic in _STATISTICS:
        ours, theirs = (
            added(runs[route.name], runs[hop.direct.name], statistic)
            for route in (hop.ours, peer.route)
        )
        label = f"{name}.added_{statistic}_vs_{peer.route.name}"
        bound = peer.bounds.get(statistic)
        yield Figure.of_runs(label, ours, theirs, "us", ratio_at_most=bound)
