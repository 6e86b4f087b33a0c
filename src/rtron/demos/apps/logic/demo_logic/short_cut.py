"""How an agent drives that was talked into a short cut: it turns to a place, then speeds there."""

from math import atan2, copysign

from .geometry import Point, Pose, Velocity, clamp, wrap_angle

FAST = 0.8
"""m/s, where the robot is allowed 0.22."""
TURN = 1.2
"""rad/s."""
_CORRECTION = 0.1


class ShortCut:
    """A short cut to a place, begun at a pose at `now` (simulated seconds).

    It turns for as long as that takes. On the straight it corrects its course only a little, so
    that the commands by themselves lead to the place, also where nothing obeys them.
    """

    def __init__(self, pose: Pose, place: Point, now: float) -> None:
        self._place = place
        aside = _aside(pose, place)
        self._turn = copysign(TURN, aside)
        self._straight_from = now + abs(aside) / TURN

    def velocity(self, pose: Pose, now: float) -> Velocity:
        """Return the command at `now` from the pose that the robot has."""
        if now < self._straight_from:
            return 0.0, self._turn
        return FAST, clamp(_aside(pose, self._place), _CORRECTION)


def _aside(pose: Pose, place: Point) -> float:
    """Return how far to the left of its heading a robot has a place, rad."""
    return wrap_angle(atan2(place[1] - pose[1], place[0] - pose[0]) - pose[2])
