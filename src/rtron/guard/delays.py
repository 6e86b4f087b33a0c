"""How long messages take through the guard: from being read to having been handed on."""


class LatencyStatistics:
    """The mean and the worst since the last `reset`."""

    __slots__ = ("_count", "_sum", "_worst")

    def __init__(self) -> None:
        self._count = self._sum = self._worst = 0

    def add(self, latency: int) -> None:
        """Take one delay, ns."""
        self._count += 1
        self._sum += latency
        self._worst = max(self._worst, latency)

    def reset(self) -> tuple[float, float] | None:
        """Return mean and worst, us, and begin anew; None if there was no message."""
        if not self._count:
            return None
        statistics = (self._sum / self._count / 1e3, self._worst / 1e3)
        self._count = self._sum = self._worst = 0
        return statistics
