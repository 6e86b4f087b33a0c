"""A Velocity: what a message asks the robot to move at, whatever its type."""

import math
from collections.abc import Callable
from dataclasses import dataclass

TWIST_COMPONENTS = tuple(f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz")
"""The components of a Twist, in the order in which they stand in it."""
_SIDEWAYS = 1


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
    def side_speed(self) -> float:
        """How fast it drives sideways, m/s."""
        return abs(self.linear[_SIDEWAYS]) if len(self.linear) > _SIDEWAYS else 0.0

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
        return _scaled_to(limit, self, lambda velocity: velocity.speed)

    def turning_at_most(self, limit: float) -> "Velocity":
        """Return the velocity scaled as a whole so that `angular_speed` is at most `limit`."""
        return _scaled_to(limit, self, lambda velocity: velocity.angular_speed)

    def sideways_at_most(self, limit: float) -> "Velocity":
        """Return the velocity scaled as a whole so that `side_speed` is at most `limit`."""
        return _scaled_to(limit, self, lambda velocity: velocity.side_speed)


def _scaled_to(limit: float, velocity: Velocity, measure: Callable[[Velocity], float]) -> Velocity:
    measured = measure(velocity)
    if measured <= limit:
        return velocity
    if math.isinf(measured):
        return _scaled_to(limit, velocity.scaled(0.25), measure)
    factor, step = limit / measured, math.ulp(1.0)
    while measure(result := velocity.scaled(factor)) > limit:
        factor *= 1 - step
        step = min(2 * step, 1.0)
    return result
