"""The speed limits of the RSRCN: a fixed one, one by the frame rate, or the lower of both."""

import math

from rtron.errors import PlanError
from rtron.policies.velocity_limit.frame_monitors import FrameMonitors, FrameRateReport
from rtron.policies.velocity_limit.limiter import SpeedLimit
from rtron.vocabulary import SECOND, PolicySettings

DEFAULT_RISE = 0.5
"""How fast (m/s2) a limit by frame rate rises where the plan has no `max_accel_limit`."""


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
    """`threshold` metres for each frame of the slowest image node.

    The limit falls at once and rises at most by `max_accel_limit`: one good moment proves little.
    """

    is_variable = True

    def __init__(self, settings: PolicySettings, monitors: FrameMonitors) -> None:
        self._threshold = _required(settings.threshold, "threshold", settings)
        self._lowest = settings.lowest
        self._rise = settings.max_accel_limit or DEFAULT_RISE
        self._monitors = monitors
        self._updated_at = 0
        self._speed = math.inf
        self._last: tuple[tuple[str, float, float], SpeedLimit] | None = None

    def at(self, now: int) -> SpeedLimit:
        """Return the limit at `now`: the lowest where an image node is silent."""
        rate = self._monitors.lowest_rate(now)
        allowed = self._lowest if rate is None or rate.is_silent else self._threshold * rate.fps
        risen = self._speed + self._rise * (now - self._updated_at) / SECOND
        self._updated_at, self._speed = now, min(allowed, risen)
        if rate is None or rate.is_silent:
            return self._silent_limit(rate)
        key = (rate.monitor_id, rate.fps, self._speed)
        if self._last is None or self._last[0] != key:
            self._last = (key, self._rate_limit(rate, is_rising=self._speed < allowed))
        return self._last[1]

    def _rate_limit(self, rate: FrameRateReport, *, is_rising: bool) -> SpeedLimit:
        rising = "rises slowly to " if is_rising else ""
        source = f"{rate.monitor_id}: {rising}{rate.fps:.1f} fps x {self._threshold:g} m"
        return SpeedLimit(self._speed, f"{self._speed:.3g} m/s ({source})")

    def _silent_limit(self, rate: FrameRateReport | None) -> SpeedLimit:
        who = f"{rate.monitor_id} is silent" if rate else "no image node is monitored"
        return SpeedLimit(self._speed, f"{self._speed:g} m/s ({who})")


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
