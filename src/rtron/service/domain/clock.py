"""The clocks of the service, passed in so that tests can set them.

The wall clock says when something was; it may be set, back too. What lasts for a while is measured
with clocks that are not set back.
"""

import time
from collections.abc import Callable
from threading import Lock

Clock = Callable[[], int]
"""Returns a time, ns; a wall clock's is since 1970."""

wall_clock: Clock = time.time_ns
monotonic_clock: Clock = time.monotonic_ns


class SteadyClock:
    """A wall clock that goes on as before where the system's is set back; thread-safe.

    For what ends at a time that was said before: a wall clock set back by two hours would keep it
    for two hours more.
    """

    def __init__(self, wall: Clock, monotonic: Clock) -> None:
        self._wall, self._monotonic = wall, monotonic
        self._lock = Lock()
        self._last, self._last_monotonic = wall(), monotonic()

    def __call__(self) -> int:
        """Return the time, ns since 1970; never less than at the call before."""
        with self._lock:
            monotonic = self._monotonic()
            self._last = max(self._wall(), self._last + monotonic - self._last_monotonic)
            self._last_monotonic = monotonic
            return self._last
