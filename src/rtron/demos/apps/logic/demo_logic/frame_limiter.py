"""A limit on the images that are processed: no more than the robot's computer can."""

_MAX_CREDIT = 2.0
_ROUNDING = 1e-6


class FrameLimiter:
    """Skips images so that at most `rate` a simulated second are processed."""

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self._credit = 1.0
        self._last: float | None = None

    def accepts(self, now: float) -> bool:
        """Return whether the image that came at `now` (simulated seconds) is processed."""
        if self._last is not None:
            self._credit += max(0.0, now - self._last) * self.rate
        self._last, self._credit = now, min(self._credit, _MAX_CREDIT)
        if self._credit < 1 - _ROUNDING:
            return False
        self._credit -= 1
        return True
