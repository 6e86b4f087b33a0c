"""The velocity that the motors are told to have: held until the next comes, but not for long."""

from rtron.demos.world.robot_base import STEP, Velocity, clipped

STILL = (0.0, 0.0)
HOLD = 0.5
"""Without a word for so long, s, the motors stop (TurtleBot3's firmware: CONTROL_MOTOR_TIMEOUT)."""


class Command:
    """Takes velocities whenever they come, and tells what they were on average within a step.

    Senders that are faster than the world's steps so have their share of a step each, as they
    have on a motor; who comes last in a step is no matter of luck.
    """

    def __init__(self) -> None:
        self.held: Velocity = STILL
        """m/s, rad/s."""
        self._since = 0.0
        self._way: list[float] | None = None
        self._silent = 0

    def take(self, velocity: Velocity, share: float) -> None:
        """Hold a velocity, which came when `share` (0 to 1) of the step had passed."""
        now = max(self._since, min(1.0, share))
        self._way = self._summed(now)
        self._since, self.held, self._silent = now, clipped(velocity), 0

    def mean(self) -> Velocity:
        """End a step, and return what was held on average within it."""
        if self._way is None:
            self._silent += 1
            return self.held if self._silent * STEP < HOLD else STILL
        v, w = self._summed(1.0)
        self._since, self._way = 0.0, None
        return v, w

    def _summed(self, now: float) -> list[float]:
        before = self._way or STILL
        lasted = now - self._since
        return [a + lasted * b for a, b in zip(before, self.held, strict=True)]
