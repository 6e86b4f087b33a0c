"""The robot's battery: it empties by and by, whatever the robot does."""

_LASTS = 9000.0
"""Simulated s: two and a half hours."""
_EMPTY, _FULL = 11.1, 12.6
"""V."""


def battery_percentage(t: float) -> float:
    """Return what is left at `t` (simulated s since the world began), 0 to 1."""
    return max(0.0, 1.0 - t / _LASTS)


def battery_voltage(t: float) -> float:
    """Return the battery's voltage at `t` (simulated s since the world began), V."""
    return _EMPTY + (_FULL - _EMPTY) * battery_percentage(t)
