"""Detect that the robot moves from the topics that it publishes."""

from collections.abc import Sequence
from math import hypot

_CARRIED = 0.5
_MOVED = 0.05
_CHANGED, _CHANGED_SHARE = 0.04, 0.15


class OdometryMotion:
    """Detects from positions that the robot has left the point where it stood."""

    def __init__(self) -> None:
        self._from: tuple[float, float] | None = None
        self._last = (0.0, 0.0)

    def reset(self) -> None:
        """Start again at the next position."""
        self._from = None

    def has_moved(self, position: Sequence[float]) -> bool:
        """Take a position (metres); a robot that was carried elsewhere stands there anew."""
        x, y = position
        if self._from is None or hypot(x - self._last[0], y - self._last[1]) > _CARRIED:
            self._from = (x, y)
        self._last = (x, y)
        return hypot(x - self._from[0], y - self._from[1]) > _MOVED


class ScanMotion:
    """Detects it from scans: many rays have another length than where the robot stood."""

    def __init__(self) -> None:
        self._from: Sequence[float] | None = None
        self._moved = False

    def reset(self) -> None:
        """Start again at the next scan."""
        self._from, self._moved = None, False

    def has_moved(self, ranges: Sequence[float]) -> bool:
        """Take the ranges of a scan (metres); true from the first that differs, until `reset`."""
        if self._from is None or len(self._from) != len(ranges):
            self._from = ranges
        if not self._moved:
            changed = sum(abs(a - b) > _CHANGED for a, b in zip(self._from, ranges, strict=True))
            self._moved = changed > _CHANGED_SHARE * len(ranges)
        return self._moved
