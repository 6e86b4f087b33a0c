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
