"""A Velocity: what a message asks the robot to move at, whatever its type."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Velocity:
    """Linear (m/s) and angular (rad/s) components, as many as the message has.

    A Twist has three of each; an AckermannDrive its speed, since its steering angle is the
    curvature; a maximal velocity has one linear component.
    """

    linear: tuple[float, ...]
    angular: tuple[float, ...] = ()

    @property
    def speed(self) -> float:
        """The length of the linear part, m/s; Inf or NaN if a component is."""
        return math.hypot(*self.linear)

    @property
    def angular_speed(self) -> float:
        """The length of the angular part, rad/s."""
        return math.hypot(*self.angular)

    @property
    def is_finite(self) -> bool:
        """Whether every component is a number, neither NaN nor Inf."""
        return all(map(math.isfinite, self.linear)) and all(map(math.isfinite, self.angular))

    @property
    def is_moving(self) -> bool:
        """Whether any component differs from 0."""
        return any(self.linear) or any(self.angular)

    def scaled(self, factor: float) -> "Velocity":
        """Return every component times `factor`: the curvature stays."""
        return Velocity(
            tuple(each * factor for each in self.linear),
            tuple(each * factor for each in self.angular),
        )

    def at_most(self, limit: float) -> "Velocity":
        """Return the velocity scaled as a whole so that `speed` is at most `limit` (m/s, >= 0).

        All components must be finite. Rounding never leaves it above the limit.
        """
        speed = self.speed
        if speed <= limit:
            return self
        if math.isinf(speed):
            return self.scaled(0.25).at_most(limit)
        factor, step = limit / speed, math.ulp(1.0)
        while (result := self.scaled(factor)).speed > limit:
            factor *= 1 - step
            step = min(2 * step, 1.0)
        return result
