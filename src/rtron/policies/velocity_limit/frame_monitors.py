"""The frame rates of an app's image nodes, and the least of them."""

from collections.abc import Iterable
from dataclasses import dataclass

from rtron.policies.velocity_limit.frame_counter import FrameCounter
from rtron.vocabulary import FpsMonitor


@dataclass(frozen=True, slots=True)
class FrameRateReport:
    """What an fps_monitor reports: frames a second, and the time (ns) since the last frame.

    `age` is None where nothing came for so long that the monitor counts as silent; `fps` is 0 then.
    """

    monitor_id: str
    fps: float
    age: int | None

    @property
    def is_silent(self) -> bool:
        """Whether the image node counts as silent."""
        return self.age is None


class FrameMonitor:
    """One fps_monitor: an image node's rate, no higher than its camera's."""

    __slots__ = ("_camera", "_frames", "_last", "_silent_after", "id")

    def __init__(self, plan: FpsMonitor) -> None:
        self.id = plan.id
        self._silent_after = plan.silent_after
        self._frames = FrameCounter(plan.window)
        self._camera = FrameCounter(plan.window) if plan.camera else None
        self._last: int | None = None

    def add_frame(self, stamp: int, now: int) -> None:
        """Note what the image node published for a frame."""
        if self._frames.add_frame(stamp, now):
            self._last = now

    def add_camera_frame(self, stamp: int, now: int) -> None:
        """Note a frame of the camera."""
        if self._camera:
            self._camera.add_frame(stamp, now)

    def rate(self, now: int) -> FrameRateReport:
        """Return the rate at `now`."""
        if self._last is None or now - self._last >= self._silent_after:
            return FrameRateReport(self.id, 0.0, None)
        fps = self._frames.rate(now)
        if self._camera:
            fps = min(fps, self._camera.rate(now))
        return FrameRateReport(self.id, fps, now - self._last)

    def silence_deadline(self) -> int | None:
        """Return when the image node counts as silent if it says nothing more."""
        return None if self._last is None else self._last + self._silent_after


class FrameMonitors:
    """All fps_monitors of an app."""

    def __init__(self, monitors: Iterable[FpsMonitor] = ()) -> None:
        self.monitors = {plan.id: FrameMonitor(plan) for plan in monitors}

    def lowest_rate(self, now: int) -> FrameRateReport | None:
        """Return the least rate at `now`, a silent one first; None if nothing is monitored."""
        rates = (monitor.rate(now) for monitor in self.monitors.values())
        return min(rates, key=lambda rate: (not rate.is_silent, rate.fps), default=None)

    def deadline(self, now: int) -> int | None:
        """Return when the next image node falls silent, if none speaks before."""
        times = (monitor.silence_deadline() for monitor in self.monitors.values())
        return min((time for time in times if time is not None and time > now), default=None)
