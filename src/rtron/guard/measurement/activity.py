"""When a publisher is active: the gaps within its phases of activity, and the pauses between them.

A gap ends a phase if it is longer than ten times the usual one (the median), and than a second:
the rule by which openpilot takes an input as lagging (commaai/opendbc, `safety/safety.h`).
"""

from rtron.guard.measurement.histogram import Histogram
from rtron.vocabulary import SECOND

_LAGGING = 10
_FRESH = 3


class ActivityPhases:
    """The phases of one publisher; `last_time` is its last message (ns), None before the first."""

    __slots__ = ("_gaps", "_limit", "_typical_gap", "last_time", "messages")

    def __init__(self) -> None:
        self._gaps = Histogram[int]()
        self._typical_gap = 0
        self._limit = SECOND
        self.last_time: int | None = None
        self.messages = 0

    def add_message(self, now: int) -> int | None:
        """Note a message at `now`; return the gap (ns) within the phase, None if a phase begins."""
        self.messages += 1
        last, self.last_time = self.last_time, now
        if last is None:
            return None
        gap = max(now - last, 0)
        self._gaps.add(gap)
        if not self._gaps.count & (self._gaps.count - 1):
            self._update_limit()
        return gap if gap <= self._limit else None

    def is_active(self, now: int) -> bool:
        """Return whether it is in the midst of a phase, by its usual gap."""
        return self.last_time is not None and now - self.last_time <= _FRESH * self._typical_gap

    def is_over(self, now: int) -> bool:
        """Return whether its last phase is over."""
        return self.last_time is not None and now - self.last_time > self._limit

    def gaps_and_pauses(self) -> tuple[Histogram[int], Histogram[int]]:
        """Return the gaps within phases, and the pauses between them."""
        self._update_limit()
        return self._gaps.split_at(self._limit)

    def _update_limit(self) -> None:
        self._typical_gap = self._gaps.quantile(0.5, 0)
        self._limit = max(SECOND, _LAGGING * self._typical_gap)
