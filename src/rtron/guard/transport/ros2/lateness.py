"""Whose messages come late: a guard that was stalled does not do what was meant for the moment.

DDS tells when a message was said by its publisher's wall clock, which need not be ours. So each
publisher's messages are compared with how long they take as a rule, by these two clocks. When they
were received does not matter: while the whole process is stopped, nothing is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

_LATE = SECOND // 4
"""Half of the time after which a flow is silent, as a rule."""
_CLOCK_CHANGE_TIMEOUT = SECOND
_SMOOTHING_SHIFT = 8
_MOST = 256


@dataclass(slots=True)
class _TypicalDelay:
    """How long a publisher's messages take (ns, by two clocks); since when they come late."""

    delay: int
    late_since: int | None = None


class LatenessDetector:
    """Tells whether a message took 250 ms longer than its publisher's do.

    A clock that was set makes all late, but for a second only: then that is how it is.
    """

    def __init__(self) -> None:
        self._typical_delays: dict[bytes, _TypicalDelay] = {}

    def is_late(
        self, publisher: bytes, source_time: int, now: int, steady_clock: Callable[[], int]
    ) -> bool:
        """Tell it of a message that is taken `now`; `source_time` is 0 if nobody knows (wall clocks, ns).

        `steady_clock` tells the time by a clock that nobody sets.
        """
        if not source_time:
            return False
        typical = self._typical_delays.get(publisher)
        if typical is None:
            self._add_publisher(publisher, now - source_time)
            return False
        excess = now - source_time - typical.delay
        if excess > _LATE:
            return self._is_still_late(typical, now - source_time, steady_clock())
        typical.delay += excess if excess < 0 else excess >> _SMOOTHING_SHIFT
        typical.late_since = None
        return False

    def _add_publisher(self, publisher: bytes, delay: int) -> None:
        if len(self._typical_delays) == _MOST:
            self._typical_delays.clear()
        self._typical_delays[publisher] = _TypicalDelay(delay)

    def _is_still_late(self, typical: _TypicalDelay, delay: int, steady: int) -> bool:
        if typical.late_since is None:
            typical.late_since = steady
        if steady - typical.late_since < _CLOCK_CHANGE_TIMEOUT:
            return True
        typical.delay, typical.late_since = delay, None
        return False
