"""Frame rates that are measured while they are used."""

from collections.abc import Iterable

from rtron.guard.measurement.activity import Phases
from rtron.guard.measurement.histogram import Histogram, duration_figures, value_figures
from rtron.policies.velocity_limit.frame_monitors import Monitor
from rtron.vocabulary import FpsMonitor, MonitorFigures


class MeasuredMonitor(Monitor):
    """An fps_monitor that keeps the gaps between the frames that count, and their rate."""

    __slots__ = ("_began", "_fps", "_phases", "_window")

    def __init__(self, plan: FpsMonitor) -> None:
        super().__init__(plan)
        self._window = plan.window
        self._phases = Phases()
        self._fps = Histogram[float]()
        self._began: int | None = None

    def frame(self, stamp: int, now: int) -> None:
        """Note what the image node published for a frame."""
        before = self._last
        super().frame(stamp, now)
        if self._last == before:
            return
        if self._phases.heard(now) is None:
            self._began = now
        if self.warm(now):
            self._fps.add(self.rate(now).fps)

    def warm(self, now: int) -> bool:
        """Tell whether a whole window was seen since frames come: the rate is a rate by then."""
        return self._began is not None and now - self._began >= self._window

    def figures(self) -> MonitorFigures:
        """Return what was measured."""
        gaps, pauses = self._phases.parted()
        return MonitorFigures(
            id=self.id,
            frames=self._phases.messages,
            gaps=duration_figures(gaps),
            pauses=duration_figures(pauses),
            fps=value_figures(self._fps),
        )


class MeasuredRates:
    """The monitors of an app, and the least of their rates."""

    def __init__(self, monitors: Iterable[FpsMonitor]) -> None:
        self.monitors = {plan.id: MeasuredMonitor(plan) for plan in monitors}

    def silent(self, now: int) -> bool:
        """Tell whether an image node is silent."""
        return any(monitor.rate(now).silent for monitor in self.monitors.values())

    def least(self, now: int) -> float:
        """Return the least rate, frames a second; 0 while one of them is not known yet."""
        monitors = self.monitors.values()
        if not all(monitor.warm(now) for monitor in monitors):
            return 0.0
        return min((monitor.rate(now).fps for monitor in monitors), default=0.0)
