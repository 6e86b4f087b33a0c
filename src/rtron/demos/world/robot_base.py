"""The robot's body and drive: a TurtleBot3 burger whose motor allows more than its maker does."""

RADIUS = 0.105
"""m."""
MAX_VELOCITY = (2.0, 2.84)
"""m/s and rad/s, both directions."""
MAX_ACCELERATION = (2.5, 6.0)
"""m/s2 and rad/s2."""
STEP = 0.05
"""Simulated s between two states of the world."""
PEDESTRIAN_RADIUS = 0.17
"""m."""

Velocity = tuple[float, float]


def clip_velocity(velocity: Velocity) -> Velocity:
    """Return the velocity within what the motors can do."""
    v, w = (max(-most, min(most, x)) for x, most in zip(velocity, MAX_VELOCITY, strict=True))
    return v, w


ZERO_VELOCITY = (0.0, 0.0)
COMMAND_TIMEOUT = 0.5
"""Without a word for so long, s, the motors stop (TurtleBot3's firmware: CONTROL_MOTOR_TIMEOUT)."""


class VelocityCommand:
    """Takes velocities whenever they come, and tells what they were on average within a step.

    Senders that are faster than the world's steps so have their share of a step each, as they
    have on a motor; who comes last in a step is no matter of luck.
    """

    def __init__(self) -> None:
        self.velocity: Velocity = ZERO_VELOCITY
        """m/s, rad/s."""
        self._since = 0.0
        self._integral: list[float] | None = None
        self._silent_steps = 0

    def set_velocity(self, velocity: Velocity, step_fraction: float) -> None:
        """Hold a velocity, which came when `step_fraction` (0 to 1) of the step had passed."""
        now = max(self._since, min(1.0, step_fraction))
        self._integral = self._integrate(now)
        self._since, self.velocity, self._silent_steps = now, clip_velocity(velocity), 0

    def end_step(self) -> Velocity:
        """End a step, and return what was held on average within it."""
        if self._integral is None:
            self._silent_steps += 1
            return self.velocity if self._silent_steps * STEP < COMMAND_TIMEOUT else ZERO_VELOCITY
        v, w = self._integrate(1.0)
        self._since, self._integral = 0.0, None
        return v, w

    def _integrate(self, now: float) -> list[float]:
        before = self._integral or ZERO_VELOCITY
        lasted = now - self._since
        return [a + lasted * b for a, b in zip(before, self.velocity, strict=True)]
