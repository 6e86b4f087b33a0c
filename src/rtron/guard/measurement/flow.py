"""Figures of one flow."""

from rtron.guard.measurement.activity import ActivityPhases
from rtron.guard.measurement.histogram import Histogram, duration_figures, value_figures
from rtron.vocabulary import (
    Decision,
    Flow,
    FlowStatistics,
    OverlapStatistics,
    PolicyName,
    RefusalStatistics,
    Velocity,
    Verdict,
)

_LONGEST_REASON = 200


class FlowMeasurement:
    """The figures of one flow as they grow."""

    __slots__ = (
        "_activity",
        "_left_moving",
        "_moving",
        "_overlaps",
        "_refusals",
        "_speeds",
        "flow",
        "takes",
        "undone",
        "waits",
    )

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.waits = Histogram[int]()
        self.takes = Histogram[int]()
        self.undone = 0
        self._activity = ActivityPhases()
        self._speeds = Histogram[float]()
        self._moving = False
        self._left_moving = 0
        self._overlaps: dict[str, int] = {}
        self._refusals: dict[tuple[PolicyName, Decision], tuple[int, Verdict]] = {}

    @property
    def messages(self) -> int:
        """How many messages came."""
        return self._activity.messages

    def add_message(self, now: int) -> int | None:
        """Note a message; return the gap (ns) before it, None if a phase begins."""
        gap = self._activity.add_message(now)
        if gap is None and self._moving:
            self._left_moving += 1
        return gap

    def is_active(self, now: int) -> bool:
        """Return whether the flow is in the midst of a phase."""
        return self._activity.is_active(now)

    def add_overlap(self, other: str, duration: int) -> None:
        """Note that another flow was active at the same time."""
        self._overlaps[other] = self._overlaps.get(other, 0) + duration

    def add_velocity(self, velocity: Velocity, *, moves: bool) -> None:
        """Note a velocity; `moves` says whether the robot moves with it."""
        self._speeds.add(velocity.speed)
        self._moving = moves

    def add_refusal(self, verdict: Verdict) -> None:
        """Note a verdict that a message would not have passed unchanged."""
        key = verdict.policy, verdict.decision
        count, _ = self._refusals.get(key, (0, verdict))
        self._refusals[key] = count + 1, verdict

    def figures(self, now: int, still_open: int) -> FlowStatistics:
        """Return the figures until `now`."""
        gaps, pauses = self._activity.gaps_and_pauses()
        return FlowStatistics(
            flow=self.flow.name,
            publisher=self.flow.publisher,
            messages=self.messages,
            gaps=duration_figures(gaps),
            pauses=duration_figures(pauses),
            active=gaps.total(0),
            left_moving=self._left_moving + (self._moving and self._activity.is_over(now)),
            waits=duration_figures(self.waits),
            takes=duration_figures(self.takes),
            undone=self.undone + still_open,
            speeds=value_figures(self._speeds),
            refusals=tuple(_refusal_figures(*each) for each in self._refusals.values()),
            overlaps=tuple(
                OverlapStatistics(flow=k, duration=v) for k, v in self._overlaps.items()
            ),
        )


def _refusal_figures(count: int, last: Verdict) -> RefusalStatistics:
    return RefusalStatistics(
        policy=last.policy,
        decision=last.decision,
        count=count,
        reason=last.reason[:_LONGEST_REASON],
    )
