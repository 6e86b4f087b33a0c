"""The velocity that the motors are told to have: held until the next comes, but not for long."""

from rtron.demos.world.robot_base import STEP, Velocity, clip_velocity

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
