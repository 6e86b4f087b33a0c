"""Frame rates that are measured while they are used."""

from collections.abc import Iterable

from rtron.guard.measurement.activity import ActivityPhases
from rtron.guard.measurement.histogram import Histogram, duration_figures, value_figures
from rtron.policies.velocity_limit.frame_monitors import FrameMonitor
from rtron.vocabulary import FpsMonitor, MonitorStatistics


class MeasuredFrameMonitor(FrameMonitor):
    """An fps_monitor that keeps the gaps between the frames that count, and their rate."""

    __slots__ = ("_active_since", "_activity", "_fps", "_window")

    def __init__(self, plan: FpsMonitor) -> None:
        super().__init__(plan)
        self._window = plan.window
        self._activity = ActivityPhases()
        self._fps = Histogram[float]()
        self._active_since: int | None = None

    def add_frame(self, stamp: int, now: int) -> None:
        """Note a frame of the image node."""
        before = self._last
        super().add_frame(stamp, now)
        if self._last == before:
            return
        if self._activity.add_message(now) is None:
            self._active_since = now
        if self.is_warm(now):
            self._fps.add(self.rate(now).fps)

    def is_warm(self, now: int) -> bool:
        """Return whether frames have come for a whole window: before that there is no rate."""
        return self._active_since is not None and now - self._active_since >= self._window

    def figures(self) -> MonitorStatistics:
        """Return the figures."""
        gaps, pauses = self._activity.gaps_and_pauses()
        return MonitorStatistics(
            id=self.id,
            frames=self._activity.messages,
            gaps=duration_figures(gaps),
            pauses=duration_figures(pauses),
            fps=value_figures(self._fps),
        )


class FrameRateMeasurement:
    """The monitors of an app, and their lowest rate."""

    def __init__(self, monitors: Iterable[FpsMonitor]) -> None:
        self.monitors = {plan.id: MeasuredFrameMonitor(plan) for plan in monitors}

    def is_silent(self, now: int) -> bool:
        """Return whether an image node is silent."""
        return any(monitor.rate(now).is_silent for monitor in self.monitors.values())

    def least(self, now: int) -> float:
        """Return the lowest rate, frames a second; 0 while one of them is unknown."""
        monitors = self.monitors.values()
        if not all(monitor.is_warm(now) for monitor in monitors):
            return 0.0
        return min((monitor.rate(now).fps for monitor in monitors), default=0.0)
