"""Rate limit of log messages: one a second for each key."""

from collections.abc import Hashable

from rtron.vocabulary import SECOND

PERIOD = SECOND


class LogThrottle:
    """Remembers when each key was logged last."""

    def __init__(self) -> None:
        self._last_times: dict[Hashable, int] = {}

    def allows(self, key: Hashable, now: int) -> bool:
        """Return whether `key` may be logged: not within a second of the last time it was."""
        last_time = self._last_times.get(key)
        if last_time is not None and now - last_time < PERIOD:
            return False
        self._last_times[key] = now
        return True
