"""The limits of the RSRCN beside the linear one: turning, driving sideways and accelerating."""

import math

from rtron.vocabulary import SECOND, PolicySettings, Velocity

_LONGEST_STEP = SECOND // 10
"""Commands that come more rarely raise the speed no more than these: a pause is no run-up."""
_KNOWN_FOR = SECOND
"""A velocity that went out longer ago says nothing of the robot, which counts as at rest."""


class MotionBounds:
    """The greatest turn and the greatest speed sideways; each scales the velocity as a whole."""

    __slots__ = ("_side", "_turn")

    def __init__(self, settings: PolicySettings) -> None:
        self._turn = settings.max_turn_limit
        self._side = settings.max_side_limit

    def apply(self, velocity: Velocity) -> tuple[Velocity, str]:
        """Return the velocity within the limits, and which of them was the tightest, or ""."""
        reason = ""
        if self._turn is not None and velocity.angular_speed > self._turn:
            velocity = velocity.turning_at_most(self._turn)
            reason = f"{self._turn:g} rad/s (max_turn_limit)"
        if self._side is not None and velocity.side_speed > self._side:
            velocity = velocity.sideways_at_most(self._side)
            reason = f"{self._side:g} m/s sideways (max_side_limit)"
        return velocity, reason


class AccelerationLimit:
    """How fast the speed may rise; it may fall as fast as anybody likes.

    What counts is the part of the velocity that goes the new way: to turn back is to begin at rest.
    """

    __slots__ = ("_accel", "last_sent")

    def __init__(self, settings: PolicySettings) -> None:
        self._accel = settings.max_accel_limit
        self.last_sent: tuple[Velocity, int] | None = None
        """What went out last, also in a stop, and when (ns)."""

    def note_sent(self, velocity: Velocity, now: int) -> None:
        """Note that a velocity goes out at `now`."""
        self.last_sent = (velocity, now)

    def apply(self, velocity: Velocity, now: int) -> tuple[Velocity, str]:
        """Return the velocity that may go out at `now`, and why it was changed, or ""."""
        if self._accel is None:
            return velocity, ""
        before, passed = self._speed_before(velocity, now)
        slower = velocity.at_most(before + self._accel * passed / SECOND)
        reason = f"{slower.speed:.3g} m/s (max_accel_limit)"
        return (velocity, "") if slower is velocity else (slower, reason)

    def _speed_before(self, velocity: Velocity, now: int) -> tuple[float, int]:
        """Return how fast it goes the way of `velocity` already, and for how long it may rise."""
        if self.last_sent is None or now - self.last_sent[1] >= _KNOWN_FOR:
            return 0.0, _LONGEST_STEP
        last, at = self.last_sent
        return _part_along(last, velocity), min(now - at, _LONGEST_STEP)


def _part_along(last: Velocity, velocity: Velocity) -> float:
    speed = velocity.speed
    if not last.linear or speed == 0 or math.isinf(speed):
        return 0.0
    pairs = zip(last.linear, velocity.linear, strict=True)
    along = sum(one * (other / speed) for one, other in pairs)
    return max(0.0, along)
