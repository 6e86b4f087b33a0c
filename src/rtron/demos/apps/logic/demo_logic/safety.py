"""Safe teleoperation: what a person asks for, held back where the lidar sees something near."""

from collections.abc import Sequence
from math import inf, pi

from .geometry import Velocity, turned

STOP_WITHIN = 0.25
"""Metres."""
_HALF_SECTOR = pi / 6


def nearest_ahead(ranges: Sequence[float], first: float, step: float) -> float:
    """Return the shortest range of a scan in the sector ahead, metres; rays without echo are 0."""
    return min(
        (
            distance
            for ray, distance in enumerate(ranges)
            if distance > 0 and abs(turned(first + ray * step)) <= _HALF_SECTOR
        ),
        default=inf,
    )


def safe(wanted: Velocity, ahead: float) -> Velocity:
    """Return the command without its way forwards if something is `ahead` metres away or less."""
    forwards, turn = wanted
    return (min(forwards, 0.0), turn) if ahead <= STOP_WITHIN else wanted


class Safety:
    """What the last scan leaves of a command; before the first there is no way forwards."""

    def __init__(self) -> None:
        self._ahead = 0.0

    def saw(self, ranges: Sequence[float], first: float, step: float) -> None:
        """Take a scan: its ranges (metres), the angle of its first ray and between rays (rad)."""
        self._ahead = nearest_ahead(ranges, first, step)

    def held(self, wanted: Velocity) -> Velocity:
        """Return what is left of a command."""
        return safe(wanted, self._ahead)
