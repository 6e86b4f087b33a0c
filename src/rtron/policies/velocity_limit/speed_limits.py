"""The speed limits of the RSRCN: a fixed one, one by the frame rate, or the lower of both."""

from rtron.errors import PlanError
from rtron.policies.velocity_limit.frame_monitors import FrameMonitors, FrameRateReport
from rtron.policies.velocity_limit.limiter import SpeedLimit
from rtron.vocabulary import PolicySettings


class FixedLimit:
    """The limit that the end user sets (`max_vel_limit`)."""

    is_variable = False

    def __init__(self, settings: PolicySettings) -> None:
        speed = _required(settings.max_vel_limit, "max_vel_limit", settings)
        self._limit = SpeedLimit(speed, f"{speed:g} m/s (max_vel_limit)")

    def at(self, now: int) -> SpeedLimit:  # noqa: ARG002
        """Return the limit, the same at all times."""
        return self._limit


class FrameRateLimit:
    """`threshold` metres for each frame of the slowest image node."""

    is_variable = True

    def __init__(self, settings: PolicySettings, monitors: FrameMonitors) -> None:
        self._threshold = _required(settings.threshold, "threshold", settings)
        self._lowest = settings.lowest
        self._monitors = monitors
        self._last: tuple[tuple[str, float], SpeedLimit] | None = None

    def at(self, now: int) -> SpeedLimit:
        """Return the limit at `now`: the lowest where an image node is silent."""
        rate = self._monitors.lowest_rate(now)
        if rate is None or rate.is_silent:
            return self._silent_limit(rate)
        key = (rate.monitor_id, rate.fps)
        if self._last is None or self._last[0] != key:
            self._last = (key, self._rate_limit(rate))
        return self._last[1]

    def _rate_limit(self, rate: FrameRateReport) -> SpeedLimit:
        speed = self._threshold * rate.fps
        why = f"{speed:.3g} m/s ({rate.monitor_id}: {rate.fps:.1f} fps x {self._threshold:g} m)"
        return SpeedLimit(speed, why)

    def _silent_limit(self, rate: FrameRateReport | None) -> SpeedLimit:
        who = f"{rate.monitor_id} is silent" if rate else "no image node is monitored"
        return SpeedLimit(self._lowest, f"{self._lowest:g} m/s ({who})")


class LowestLimit:
    """The lower of two limits."""

    is_variable = True

    def __init__(self, one: FixedLimit, other: FrameRateLimit) -> None:
        self._one = one
        self._other = other

    def at(self, now: int) -> SpeedLimit:
        """Return the lower limit at `now`."""
        return min(self._other.at(now), self._one.at(now), key=lambda limit: limit.speed)


def _required(value: float | None, key: str, settings: PolicySettings) -> float:
    if value is None:
        raise PlanError(f"{settings.policy} needs {key}", help=f"set {key} of the RSRCN")
    return value
