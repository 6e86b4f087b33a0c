"""How long another process has given no sign of life; sans-I/O."""

from rtron.vocabulary import SECOND

LOOK = SECOND // 100
"""The time between two beats, and between two looks at them, ns."""
_LONGEST_LOOK = 3 * LOOK


class Watchdog:
    """Watches a beat, a number that changes while all is well.

    Time in which nobody looked counts for little: after both processes stood still, or the one
    that looks did, the other has to be given the time to beat again.
    """

    def __init__(self, now: int) -> None:
        self._looked = now
        self._beat = 0
        self.silent = 0

    def look(self, now: int, beat: int) -> int:
        """Return how long the beat has been missing, ns."""
        since, self._looked = now - self._looked, now
        self.silent = 0 if beat != self._beat else self.silent + min(since, _LONGEST_LOOK)
        self._beat = beat
        return self.silent
