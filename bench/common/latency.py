"""Medians and percentiles over all runs, in microseconds."""

import statistics
from collections.abc import Iterable, Sequence

from bench.common.pubsub import LoadResult

_US = 1000.0


def pooled(runs: Iterable[LoadResult]) -> list[int]:
    """Return the latencies of all runs, ns, sorted."""
    return sorted(latency for run in runs for latency in run.latencies_ns)


def quantile(ordered: Sequence[int], part: float) -> float:
    """Return the value that `part` of the sorted values (ns) do not exceed, us."""
    last = len(ordered) - 1
    return ordered[min(last, int(part * len(ordered)))] / _US


def median(runs: Iterable[LoadResult]) -> float:
    """Return the median latency, us."""
    return quantile(pooled(runs), 0.5)


def p99(runs: Iterable[LoadResult]) -> float:
    """Return the latency that one message of a hundred exceeds, us."""
    return quantile(pooled(runs), 0.99)


def typical_p99(runs: Iterable[LoadResult]) -> float:
    """Return the median over the runs of each one's p99, us: one disturbed run does not show."""
    return statistics.median(p99([run]) for run in runs)
