"""Teleoperation: a person's command, without its forward part near an obstacle."""

from collections.abc import Sequence
from math import inf, isfinite, pi
from pathlib import Path

from .geometry import Velocity, wrap_angle


def read_command(path: str) -> Velocity | None:
    """Return the velocity in a file, "forwards turn" (m/s, rad/s); None if there is none.

    The file is there while the command holds.
    """
    try:
        forwards, turn = map(float, Path(path).read_text(encoding="utf-8").split())
    except (OSError, ValueError):
        return None
    return (forwards, turn) if isfinite(forwards) and isfinite(turn) else None


STOP_WITHIN = 0.25
"""Metres."""
_HALF_SECTOR = pi / 6


def nearest_ahead(ranges: Sequence[float], first: float, step: float) -> float:
    """Return the shortest range of a scan in the sector ahead, metres; rays without echo are 0."""
    return min(
        (
            distance
            for ray, distance in enumerate(ranges)
            if distance > 0 and abs(wrap_angle(first + ray * step)) <= _HALF_SECTOR
        ),
        default=inf,
    )


class TeleopSafety:
    """Limits commands by the last scan; before the first scan nothing drives forwards."""

    def __init__(self) -> None:
        self._ahead = 0.0

    def set_scan(self, ranges: Sequence[float], first: float, step: float) -> None:
        """Take a scan: its ranges (metres), the angle of its first ray and between rays (rad)."""
        self._ahead = nearest_ahead(ranges, first, step)

    def limit(self, command: Velocity) -> Velocity:
        """Return the command, without forward velocity if something is too near."""
        forwards, turn = command
        return (min(forwards, 0.0), turn) if self._ahead <= STOP_WITHIN else command
