"""Saying the same thing once a second at most, so that a flood of events is none of log lines."""

from collections.abc import Hashable

from rtron.vocabulary import SECOND

PERIOD = SECOND


class LogThrottle:
    """Tells whether it is time to say something again."""

    def __init__(self) -> None:
        self._last_times: dict[Hashable, int] = {}

    def allows(self, key: Hashable, now: int) -> bool:
        """Tell whether `key` was not said within the last second, and take it as said."""
        last_time = self._last_times.get(key)
        if last_time is not None and now - last_time < PERIOD:
            return False
        self._last_times[key] = now
        return True
