"""How many images are worked through: no more than the robot's computer can."""

_MOST_SAVED = 2.0
_ROUNDING = 1e-6


class Pace:
    """Skips images so that no more than `rate` a simulated second are left."""

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self._saved = 1.0
        self._last: float | None = None

    def takes(self, now: float) -> bool:
        """Tell whether the image that came at `now` (simulated seconds) is worked through."""
        if self._last is not None:
            self._saved += max(0.0, now - self._last) * self.rate
        self._last, self._saved = now, min(self._saved, _MOST_SAVED)
        if self._saved < 1 - _ROUNDING:
            return False
        self._saved -= 1
        return True
