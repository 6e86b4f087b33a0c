"""How soon the robot slows down when its eyes do: Safe, while the recogniser gets slower."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rtron.demos.cases import GR, RSR, Setting
from rtron.demos.cases.rsr import CRUISE, threshold
from rtron.demos.experiment.session import Session, Started
from rtron.demos.metrics.case_run import Variant
from rtron.demos.runtime.environment import Begun
from rtron.demos.runtime.instrumentation import Pipeline
from rtron.demos.world.ground_truth import Truth
from rtron.errors import SourceError

RATE = 20.0
"""Images a simulated second: two frames at half of it take 0.2 s at speed 1."""
WINDOW = 0.2
"""So long the guard counts images, wall s: four of them, and two once they come half as often."""
_SPARE = 1.1
_CRUISING = 0.95 * CRUISE
_STEADY = 1.0
"""So long the robot has cruised before its eyes get slower, simulated s."""
_LONGEST = 10.0
"""How long each is waited for, wall s."""


@dataclass(frozen=True, slots=True)
class Adaptation:
    """The world of `seed`: wall s until the speed was at most `allowed` (m/s); None: never."""

    seed: int
    allowed: float
    after: float | None


def adaptations(begun: Begun, pipeline: Pipeline, seeds: Sequence[int]) -> list[Adaptation]:
    """Halve the recogniser's rate in each world while the robot cruises through a corridor.

    The app that the pipeline has scanned is guarded as in the RSR case: no pedestrian and no light
    slows the robot here, only the guard. SourceError if the robot never cruises.
    """
    setting = Setting(scene={}, speed=begun.speed, rate=RATE, window=WINDOW)
    launch = pipeline.guard(RSR.decisions(setting))
    with begun.launched(launch, None, pipeline.plan) as app:
        session = Session(begun, app, RATE)
        session.wait_until_connected()
        allowed = threshold(setting) * setting.wall_rate / 2 * _SPARE
        return [Adaptation(seed, allowed, _slowed(session, seed, allowed)) for seed in seeds]


def _slowed(session: Session, seed: int, allowed: float) -> float | None:
    """Return the wall s from the order to be slower to the first truth that is; None: never."""
    owner = session.begun.owner
    owner.rate(RATE)
    started = session.start(GR, seed, Variant.UNATTACKED)
    if _wait(session, started, lambda truth: truth.velocity[0] >= _CRUISING) is None:
        raise SourceError(f"the robot does not get up to {_CRUISING:g} m/s")
    steady = owner.rate(RATE) + _STEADY
    _wait(session, started, lambda truth: truth.t >= steady)
    ordered = time.monotonic()
    owner.rate(RATE / 2)
    slower = _wait(session, started, lambda truth: truth.velocity[0] <= allowed)
    return None if slower is None else slower - ordered


def _wait(session: Session, started: Started, condition: Callable[[Truth], bool]) -> float | None:
    """Wait for a truth; return when it was heard (steady clock, s), None if it never was."""
    until = time.monotonic() + _LONGEST
    while time.monotonic() < until:
        if any(map(condition, session.truths(started.run))):
            return time.monotonic()
    return None
