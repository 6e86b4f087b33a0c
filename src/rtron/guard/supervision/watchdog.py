"""Watches processes by their beats, as late as this machine is; sans-I/O."""

from rtron.vocabulary import SECOND

BEAT_PERIOD = SECOND // 100
"""The time between two beats, and between two looks at them, ns."""
_MAX_PERIOD = 5 * BEAT_PERIOD // 2
"""What one look counts at most, ns.

With `adapt_bound`, which allows for how late it is, one that is late is no stall by itself.
"""


class Watchdog:
    """Watches a beat, a number that changes while all is well.

    Time in which nobody looked counts for little: after both processes stood still, or the one
    that looks did, the other has to be given the time to beat again.
    """

    def __init__(self, now: int) -> None:
        self._updated_at = now
        self._beat = 0
        self.silence = 0

    def update(self, now: int, beat: int) -> int:
        """Return how long the beat has been missing, ns."""
        since, self._updated_at = now - self._updated_at, now
        self.silence = 0 if beat != self._beat else self.silence + min(since, _MAX_PERIOD)
        self._beat = beat
        return self.silence


_DELAY_WINDOW = SECOND


class SchedulingDelay:
    """The worst lateness of ticks in the last one to two seconds.

    They are our own: where we are late because others have the processor, so can be the process
    that we watch. Or they are its own, if it tells when they were.
    """

    def __init__(self, now: int, period: int = BEAT_PERIOD) -> None:
        """`period` is the time between two ticks that are not late, ns."""
        self._period = period
        self._updated_at = self._window_began_at = now
        self._worst = self._worst_before = 0

    def update(self, now: int) -> int:
        """Return the worst lateness (ns) after a tick at `now`."""
        late = now - self._updated_at - self._period
        self._updated_at = now
        if now - self._window_began_at >= _DELAY_WINDOW:
            self._window_began_at = now
            self._worst_before, self._worst = self._worst, 0
        self._worst = max(self._worst, late)
        return max(self._worst, self._worst_before)


def adapt_bound(bound: int, delay: int, longest: int) -> int:
    """Return how long (ns) a process may be silent that is late by `delay` because of others.

    That is `bound` at least, and at most `longest` unless `bound` is more.
    """
    return max(bound, min(3 * delay + 2 * BEAT_PERIOD, longest))


HANG_TIMEOUT = 2 * SECOND
"""Silence after which a process beside the guard is killed, ns."""
LONGEST_HANG = 10 * SECOND
"""The same where it is late often: it goes after others, and is not killed for that."""
START_TIMEOUT = 20 * SECOND
"""The same before its first beat."""


class HangWatch:
    """Tells whether a process that beats every `period` (ns) stands still."""

    def __init__(self, now: int, period: int) -> None:
        self._watchdog, self._delay = Watchdog(now), SchedulingDelay(now, period)

    def is_hung(self, now: int, beat_at: int) -> bool:
        """Return whether it does at `now`; its last beat was at `beat_at`, 0 before the first."""
        limit = START_TIMEOUT
        if beat_at:
            limit = adapt_bound(HANG_TIMEOUT, 2 * self._delay.update(beat_at), LONGEST_HANG)
        return self._watchdog.update(now, beat_at) > limit
