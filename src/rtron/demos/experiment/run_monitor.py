"""Watches a run: whether the robot comes to harm, arrives, and when there is no more to see."""

from dataclasses import dataclass, field

from rtron.demos.cases import Case
from rtron.demos.metrics.trajectory import SceneDocument
from rtron.demos.world.ground_truth import GroundTruth

ARRIVAL_RADIUS = 0.15
"""So near to the goal the robot has arrived, m: the navigation's own tolerance, and some spare."""
MAX_DURATION = 90.0
"""A run that has not ended by then (simulated s) is not completed."""
_AFTER_HARM = 3.0
_AFTER_COLLISION = 0.3
_AFTER_ARRIVAL = 2.0
_STANDSTILL_SPEED = 0.01
"""Slower than this the robot stands, m/s."""


@dataclass(slots=True)
class RunMonitor:
    """Watches the ground truth of a run of `case` in `scene`, sample by sample.

    `harm` names the first harm, "" for none; `harmed_at` and `arrived_at` are in simulated s since
    the start.
    """

    case: Case
    scene: SceneDocument
    samples: list[GroundTruth] = field(default_factory=list)
    harm: str = ""
    harmed_at: float | None = None
    arrived_at: float | None = None

    def observe(self, truth: GroundTruth) -> None:
        """Note the truth at a moment."""
        self.samples.append(truth)
        harm = self.case.find_harm(truth, self.scene)
        if harm and self.harmed_at is None:
            self.harm, self.harmed_at = harm, truth.t
        if (
            self.arrived_at is None
            and truth.distance_to_goal <= ARRIVAL_RADIUS
            and not self.collided
        ):
            self.arrived_at = truth.t

    @property
    def collided(self) -> bool:
        """Whether the robot has hit something, which it stays with."""
        return bool(self.samples) and self.samples[-1].collided

    @property
    def is_over(self) -> bool:
        """Whether there is no more to see."""
        if not self.samples:
            return False
        last = self.samples[-1]
        if last.t >= MAX_DURATION:
            return True
        if self.harmed_at is not None:
            rest = _AFTER_COLLISION if last.collided else _AFTER_HARM
            return last.t >= self.harmed_at + rest
        if self.arrived_at is None:
            return False
        return (
            abs(last.velocity[0]) < _STANDSTILL_SPEED or last.t >= self.arrived_at + _AFTER_ARRIVAL
        )
