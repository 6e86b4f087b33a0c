"""When the next step of simulated time is due on the wall's clock."""

import time
from collections.abc import Callable

_LATE = 0.5
"""Wall s; a world that is later lets simulated time go slower, and does not run after it."""


class StepClock:
    """Counts steps of `step` simulated s at `speed` simulated s a wall s, without drift."""

    def __init__(
        self, speed: float, step: float, wall: Callable[[], float] = time.monotonic
    ) -> None:
        self._pace = step / speed
        self._wall = wall
        self.lost_time = 0.0
        """Wall s by which simulated time went slower than it should."""
        self.restart()

    def restart(self) -> None:
        """Let the first step begin now."""
        self._next = self._wall() + self._pace

    def wait(self) -> float:
        """Return how long it is until the next step, wall s."""
        return max(0.0, self._next - self._wall())

    def is_due(self) -> bool:
        """Tell whether a step is due; if so it is counted as made."""
        late = self._wall() - self._next
        if late < 0:
            return False
        if late > _LATE:
            self.lost_time += late
            self._next += late
        self._next += self._pace
        return True

    def step_fraction(self) -> float:
        """Return how much of the present step has passed, 0 to 1."""
        return max(0.0, min(1.0, 1.0 - (self._next - self._wall()) / self._pace))
