"""A run of a case, measured."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import Any

from rtron.demos.metrics.message_journal import Attack, TrajectoryDeviation
from rtron.demos.world.ground_truth import GroundTruth, Position
from rtron.vocabulary import UNAPPROVED

Event = Mapping[str, Any]
"""An event as the service has it: `at` (wall ns), `kind`, `topic`, `flow`, `decision` and more."""
SECOND = 1_000_000_000
DECISIONS = ("pass", "hold", "drop", "modify")
_STOPPED = frozenset({"drop", "modify"})


@dataclass(frozen=True, slots=True)
class SecondCounts:
    """How many messages of a flow met which decision in the wall second that ends at `at` (ns)."""

    at: int
    topic: str
    flow: str
    counts: Mapping[str, int]


def decision_counts(events: Iterable[Event]) -> tuple[SecondCounts, ...]:
    """Return what the guard counted, second by second and flow by flow, in the order of time."""
    return tuple(
        SecondCounts(event["at"], topic, flow, dict(zip(DECISIONS, counts, strict=True)))
        for event in events
        if event["kind"] == "counts"
        for topic, stream in event["values"]["streams"].items()
        for flow, counts in stream["flows"].items()
    )


def first_stop(events: Iterable[Event], topic: str, attacker: str) -> float | None:
    """Return when (wall s) the first message of an attacker was stopped.

    None if no verdict tells so: one is told where it differs from its flow's before. A node that
    the plan does not name is an attacker, too.
    """
    verdict_times = (
        event["at"] / SECOND
        for event in events
        if event["kind"] == "verdict"
        and event["topic"] == topic
        and event["decision"] in _STOPPED
        and (event["publisher"] == attacker or event["flow"] == UNAPPROVED)
    )
    return min(verdict_times, default=None)


COLLISION = "collision"
_RUN_FIELDS = ("case", "ros", "seed", "speed", "outcome", "completed", "harm", "collided", "ended")
_MEASUREMENT_FIELDS = ("time_to_goal", "harmed_at", "sent", "delivered", "attack_span")
_MITIGATION_FIELDS = ("mitigation", "mitigated_after")
STOPPED, NOTHING, NEVER = "stopped", "nothing arrived", "never"


class Variant(str, Enum):
    """How a case is run."""

    UNATTACKED = "unattacked"
    ATTACKED = "attacked"
    GUARDED = "guarded"

    def __str__(self) -> str:
        return str(self.value)


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseRun:
    """What came of a run of `case` in the world of `seed`, at `speed` simulated s a wall s.

    `harm` says what harm came first, "" for none; `harmed_at` is when, `ended` when the run was
    over, `time_to_goal` when the goal was reached (simulated s since the start, None: never).
    `mitigated_after` is in wall s, None where no verdict tells it; `deviation` is from the way of
    the unattacked run.
    `publishers` names who speaks, by topic and flow of the guard.
    """

    case: str
    ros: int
    seed: int
    speed: float
    variant: Variant
    completed: bool
    harm: str
    collided: bool
    ended: float
    time_to_goal: float | None
    harmed_at: float | None
    start_wall: float
    attack: Attack = field(default_factory=Attack)
    mitigated_after: float | None = None
    deviation: TrajectoryDeviation | None = None
    samples: tuple[GroundTruth, ...] = ()
    events: tuple[Event, ...] = ()
    publishers: Mapping[tuple[str, str], str] = field(default_factory=dict)

    @property
    def trajectory(self) -> tuple[Position, ...]:
        """Where the robot went, in order."""
        return tuple(each.position for each in self.samples)

    @property
    def is_attacked(self) -> bool:
        """Whether there was to be an attack."""
        return self.variant is not Variant.UNATTACKED

    @property
    def outcome(self) -> str:
        """What came of it, in a word or two."""
        if self.harm:
            return self.harm
        return "completed" if self.completed else "not completed"

    @property
    def first_harms(self) -> dict[str, GroundTruth]:
        """The first moment of each harm that the samples show: of `harm`, and of a collision."""
        found = {}
        if self.harmed_at is not None:
            found[self.harm] = next(each for each in self.samples if each.t >= self.harmed_at)
        if self.collided and self.harm != COLLISION:
            found[COLLISION] = next(each for each in self.samples if each.collided)
        return found

    @property
    def sent(self) -> int:
        """How many malicious messages were sent."""
        return len(self.attack.sent)

    @property
    def delivered(self) -> int:
        """How many malicious messages arrived where they do harm."""
        return len(self.attack.delivered)

    @property
    def mitigation(self) -> str:
        """What became of the attack: STOPPED, NOTHING, NEVER, or "" if none was made.

        NOTHING (arrived) is where no verdict tells when one was stopped.
        """
        if not self.sent:
            return ""
        if self.mitigated_after is not None:
            return STOPPED
        return NEVER if self.delivered else NOTHING

    @property
    def attack_span(self) -> tuple[float, float] | None:
        """When the first and the last malicious message was sent, simulated s since the start."""
        if not self.attack.sent:
            return None
        first, last = self.attack.sent[0], self.attack.sent[-1]
        return (first - self.start_wall) * self.speed, (last - self.start_wall) * self.speed

    def as_json(self, *, with_samples: bool = False) -> dict[str, Any]:
        """Return the run as plain JSON, its samples only if it is to be `with_samples`."""
        found = {
            name: getattr(self, name)
            for name in (*_RUN_FIELDS, *_MEASUREMENT_FIELDS, *_MITIGATION_FIELDS)
        }
        found["variant"] = self.variant.value
        found["deviation"] = asdict(self.deviation) if self.deviation else None
        return found | (
            {"samples": [each.as_json() for each in self.samples]} if with_samples else {}
        )


RunsByVariant = Mapping[Variant, CaseRun]
"""The runs of a case in one world, by variant."""
