"""Where limits come from: the end user's word, the frame rates, or both."""

from rtron.errors import PlanError
from rtron.policies.velocity_limit.frame_monitors import Rate, Rates
from rtron.policies.velocity_limit.limiter import Limit
from rtron.vocabulary import PolicySettings


class UserLimit:
    """The end user's limit (`max_vel_limit`)."""

    varies = False

    def __init__(self, settings: PolicySettings) -> None:
        speed = _given(settings.max_vel_limit, "max_vel_limit", settings)
        self._limit = Limit(speed, f"{speed:g} m/s (max_vel_limit)")

    def at(self, now: int) -> Limit:  # noqa: ARG002
        """Return the limit, the same at all times."""
        return self._limit


class FrameLimit:
    """`threshold` metres for each frame of the slowest image node."""

    varies = True

    def __init__(self, settings: PolicySettings, rates: Rates) -> None:
        self._threshold = _given(settings.threshold, "threshold", settings)
        self._lowest = settings.lowest
        self._rates = rates
        self._last: tuple[tuple[str, float], Limit] | None = None

    def at(self, now: int) -> Limit:
        """Return the limit at `now`: the lowest where an image node is silent."""
        rate = self._rates.least(now)
        if rate is None or rate.silent:
            return self._silent(rate)
        about = (rate.monitor, rate.fps)
        if self._last is None or self._last[0] != about:
            self._last = (about, self._measured(rate))
        return self._last[1]

    def _measured(self, rate: Rate) -> Limit:
        speed = self._threshold * rate.fps
        why = f"{speed:.3g} m/s ({rate.monitor}: {rate.fps:.1f} fps x {self._threshold:g} m)"
        return Limit(speed, why)

    def _silent(self, rate: Rate | None) -> Limit:
        who = f"{rate.monitor} is silent" if rate else "no image node is monitored"
        return Limit(self._lowest, f"{self._lowest:g} m/s ({who})")


class LowerLimit:
    """The lower of two limits."""

    varies = True

    def __init__(self, one: UserLimit, other: FrameLimit) -> None:
        self._one = one
        self._other = other

    def at(self, now: int) -> Limit:
        """Return the lower limit at `now`."""
        return min(self._other.at(now), self._one.at(now), key=lambda limit: limit.speed)


def _given(value: float | None, key: str, settings: PolicySettings) -> float:
    if value is None:
        raise PlanError(f"{settings.policy} needs {key}", help=f"set {key} of the RSRCN")
    return value
