"""When somebody speaks: the gaps within phases of speaking, and the pauses between these.

A gap ends a phase if it is longer than ten times the usual one (the median), and than a second:
the rule by which openpilot takes an input as lagging (commaai/opendbc, `safety/safety.h`).
"""

from rtron.guard.measurement.histogram import Histogram
from rtron.vocabulary import SECOND

_LAGGING = 10
_FRESH = 3


class Phases:
    """The phases of one speaker; `last` is when it was heard last (ns), None before."""

    __slots__ = ("_gaps", "_limit", "_usual", "last", "messages")

    def __init__(self) -> None:
        self._gaps = Histogram[int]()
        self._usual = 0
        self._limit = SECOND
        self.last: int | None = None
        self.messages = 0

    def heard(self, now: int) -> int | None:
        """Note that it spoke at `now`; return the gap (ns) within its phase, None if one begins."""
        self.messages += 1
        last, self.last = self.last, now
        if last is None:
            return None
        gap = max(now - last, 0)
        self._gaps.add(gap)
        if not self._gaps.count & (self._gaps.count - 1):
            self._learn()
        return gap if gap <= self._limit else None

    def speaks(self, now: int) -> bool:
        """Tell whether it is in the midst of a phase, by its usual gap."""
        return self.last is not None and now - self.last <= _FRESH * self._usual

    def over(self, now: int) -> bool:
        """Tell whether its last phase is over."""
        return self.last is not None and now - self.last > self._limit

    def parted(self) -> tuple[Histogram[int], Histogram[int]]:
        """Return the gaps within phases, and the pauses between them."""
        self._learn()
        return self._gaps.parted(self._limit)

    def _learn(self) -> None:
        self._usual = self._gaps.quantile(0.5, 0)
        self._limit = max(SECOND, _LAGGING * self._usual)
