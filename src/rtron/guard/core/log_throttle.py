"""Rate limit of log messages: one a second for each key, and a bounded number of keys a second."""

from collections.abc import Hashable

from rtron.vocabulary import SECOND

PERIOD = SECOND
MAX_KEYS = 100
"""So many keys are logged in a second: strangers choose names, and must not fill the log."""


class LogThrottle:
    """Remembers which keys were logged within the last second, oldest first."""

    def __init__(self) -> None:
        self._last_times: dict[Hashable, int] = {}

    def allows(self, key: Hashable, now: int) -> bool:
        """Return whether `key` may be logged: not within a second of the last time it was."""
        self._forget(now - PERIOD)
        if key in self._last_times or len(self._last_times) == MAX_KEYS:
            return False
        self._last_times[key] = now
        return True

    def _forget(self, until: int) -> None:
        while self._last_times:
            oldest = next(iter(self._last_times))
            if self._last_times[oldest] > until:
                return
            del self._last_times[oldest]
