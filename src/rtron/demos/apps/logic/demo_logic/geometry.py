"""Angles and velocities in the plane, metres and radians."""

from math import atan2, cos, pi, sin

Point = tuple[float, float]
Pose = tuple[float, float, float]
"""x, y, and the heading counted from the x axis to the left."""
Velocity = tuple[float, float]
"""Forwards (m/s) and to the left (rad/s)."""


def wrap_angle(angle: float) -> float:
    """Return the same angle in (-pi, pi]."""
    return pi - (pi - angle) % (2 * pi)


def quaternion(heading: float) -> tuple[float, float]:
    """Return z and w of the rotation to a heading; x and y are 0."""
    return sin(heading / 2), cos(heading / 2)


def heading(z: float, w: float) -> float:
    """Return the heading of a rotation about the z axis."""
    return wrap_angle(2 * atan2(z, w))


def clamp(value: float, bound: float) -> float:
    """Return the value, limited to between -bound and bound."""
    return max(-bound, min(bound, value))
