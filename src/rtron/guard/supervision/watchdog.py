"""How long another process has given no sign of life; sans-I/O."""

from rtron.vocabulary import SECOND

BEAT_PERIOD = SECOND // 100
"""The time between two beats, and between two looks at them, ns."""
_MAX_PERIOD = 3 * BEAT_PERIOD


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
