"""A histogram whose size does not depend on how much goes in: buckets a tenth apart.

The idea is DDSketch's (Masson, Rim and Lee, VLDB 2019): a quantile of logarithmic buckets has a
bounded relative error. Each bucket keeps its own extremes, so that the greatest value is exact and
a quantile is one of the values that went in.
"""

import math
from typing import Generic, TypeVar

from rtron.vocabulary import DurationStatistics, ValueStatistics

N = TypeVar("N", int, float)
_FACTOR = 1.1
_SCALE = 1 / math.log(_FACTOR)
_SMALLEST = 1e-9
_LARGEST = 1e20


class _Bucket(Generic[N]):
    __slots__ = ("count", "greatest", "least", "total")

    def __init__(self, value: N) -> None:
        self.count = 0
        self.total: N = value - value
        self.least: N = value
        self.greatest: N = value

    def add(self, value: N) -> None:
        self.count += 1
        self.total += value
        if value < self.least:
            self.least = value
        elif value > self.greatest:
            self.greatest = value


class Histogram(Generic[N]):
    """Counts finite numbers from 0 on; at most about 700 buckets ever."""

    __slots__ = ("_buckets", "count")

    def __init__(self) -> None:
        self._buckets: dict[int, _Bucket[N]] = {}
        self.count = 0

    def add(self, value: N) -> None:
        """Count a number."""
        index = _bucket_index(value)
        bucket = self._buckets.get(index)
        if bucket is None:
            bucket = self._buckets[index] = _Bucket(value)
        bucket.add(value)
        self.count += 1

    def quantile(self, fraction: float, default: N) -> N:
        """Return the quantile of `fraction`: one of the values, at most a tenth too high."""
        rank, counted, quantile = math.ceil(fraction * self.count), 0, default
        for index in sorted(self._buckets):
            if counted >= rank and counted:
                break
            counted += self._buckets[index].count
            quantile = self._buckets[index].greatest
        return quantile

    def minimum(self, default: N) -> N:
        """Return the least value."""
        return min((bucket.least for bucket in self._buckets.values()), default=default)

    def total(self, zero: N) -> N:
        """Return the sum of all values."""
        return sum((bucket.total for bucket in self._buckets.values()), start=zero)

    def split_at(self, limit: N) -> "tuple[Histogram[N], Histogram[N]]":
        """Return the values up to `limit`, its bucket included, and those above."""
        low, high = Histogram[N](), Histogram[N]()
        for index, bucket in self._buckets.items():
            side = low if bucket.least <= limit else high
            side._buckets[index] = bucket  # noqa: SLF001 - its own class
            side.count += bucket.count
        return low, high


def duration_figures(durations: Histogram[int]) -> DurationStatistics:
    """Return the figures of durations (ns)."""
    return DurationStatistics(
        count=durations.count,
        p50=durations.quantile(0.5, 0),
        p99=durations.quantile(0.99, 0),
        p999=durations.quantile(0.999, 0),
        max=durations.quantile(1, 0),
    )


def value_figures(values: Histogram[float]) -> ValueStatistics:
    """Return the figures of any values."""
    return ValueStatistics(
        count=values.count,
        min=values.minimum(0.0),
        p50=values.quantile(0.5, 0.0),
        p99=values.quantile(0.99, 0.0),
        p999=values.quantile(0.999, 0.0),
        max=values.quantile(1, 0.0),
    )


def _bucket_index(value: float) -> int:
    if value <= _SMALLEST:
        return 0
    return 1 + int(math.log(min(value, _LARGEST) / _SMALLEST) * _SCALE)


class LatencyStatistics:
    """The mean and the maximum since the last `reset`."""

    __slots__ = ("_count", "_sum", "_worst")

    def __init__(self) -> None:
        self._count = self._sum = self._worst = 0

    def add(self, latency: int) -> None:
        """Add one latency, ns."""
        self._count += 1
        self._sum += latency
        self._worst = max(self._worst, latency)

    def reset(self) -> tuple[float, float] | None:
        """Return mean and maximum, us, and begin anew; None if there was no message."""
        if not self._count:
            return None
        statistics = (self._sum / self._count / 1e3, self._worst / 1e3)
        self._count = self._sum = self._worst = 0
        return statistics
