"""Hops of a Twist at 200 Hz: the latency that the guard adds, beside that of its peers."""

from collections.abc import Iterator

from bench.common.latency import median, p99, typical_p99
from bench.common.pubsub import Load, interleave
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import HOP_MESSAGES, RUNS
from bench.ros1.routes import direct, guard, mux, relay, ten_nodes
from figures.figure import Figure

RATE = 200
_STATISTICS = {
    "median": (median, 300.0),
    "p99": (p99, 3000.0),
    "typical_p99": (typical_p99, 3000.0),
}
"""Statistics of the added latency, each with its upper bound, us."""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give added median and p99 of the guard beside relay and mux, and the loss."""
    routes = [direct(), guard(), relay(), mux()]
    runs = interleave(testbed, routes, Load(HOP_MESSAGES, RATE), RUNS, progress)
    for name, (statistic, at_most) in _STATISTICS.items():
        none = statistic(runs["direct"])
        ours = statistic(runs["guard"]) - none
        for peer in ("relay", "mux"):
            added = statistic(runs[peer]) - none
            yield Figure(f"hop.added_{name}_vs_{peer}", ours, added, "us", at_most=at_most)
        yield Figure(f"hop.whole_{name}_vs_direct", ours + none, none, "us")
    lost = {name: sum(run.lost for run in found) for name, found in runs.items()}
    yield Figure("hop.lost", lost["guard"], lost["relay"], "messages", at_most=0)


_CHAIN_RATIO = 0.25
_CHAIN_STATISTICS = {"median": median, "p99": p99, "typical_p99": typical_p99}


def chain_figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield what ten coordination nodes on one stream add, beside ten relays in a row."""
    routes = [direct(), ten_nodes(), relay(10)]
    runs = interleave(testbed, routes, Load(HOP_MESSAGES, RATE), RUNS, progress)
    for name, statistic in _CHAIN_STATISTICS.items():
        none, ours, peer = (statistic(runs[route.name]) for route in routes)
        bound = _CHAIN_RATIO if name == "median" else None
        yield Figure(f"chain.added_{name}", ours - none, peer - none, "us", ratio_at_most=bound)
    lost = [sum(run.lost for run in runs[route.name]) for route in routes[1:]]
    yield Figure("chain.lost", lost[0], lost[1], "messages", at_most=0)
