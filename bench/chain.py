"""Ten coordination nodes on one stream of the guard, beside ten relays in a row."""

from collections.abc import Iterator

from bench.common.latency import median, p99, typical_p99
from bench.common.pubsub import Load, interleave
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import HOP_MESSAGES, RUNS
from bench.ros1.hop import RATE
from bench.ros1.routes import direct, relay, ten_nodes
from figures.figure import Figure

_AT_MOST = 0.25
_STATISTICS = {"median": median, "p99": p99, "typical_p99": typical_p99}


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give what ten add to median and p99."""
    routes = [direct(), ten_nodes(), relay(10)]
    runs = interleave(testbed, routes, Load(HOP_MESSAGES, RATE), RUNS, progress)
    for name, statistic in _STATISTICS.items():
        none, ours, peer = (statistic(runs[route.name]) for route in routes)
        bound = _AT_MOST if name == "median" else None
        yield Figure(f"chain.added_{name}", ours - none, peer - none, "us", ratio_at_most=bound)
    lost = [sum(run.lost for run in runs[route.name]) for route in routes[1:]]
    yield Figure("chain.lost", lost[0], lost[1], "messages", at_most=0)
