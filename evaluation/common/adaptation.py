"""How soon the robot slows down when its eyes do: Safe, while the recogniser gets slower."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rtron.demos.cases import GR, RSR, RunConditions
from rtron.demos.cases.paper_cases import CRUISE, threshold
from rtron.demos.experiment.session import AppSession, StartedRun
from rtron.demos.metrics.case_run import Variant
from rtron.demos.runtime.app_launch import launch_app
from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.generator import make_scene
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
class SlowdownResult:
    """The world of `seed`: wall s until the speed was at most `allowed` (m/s); None: never."""

    seed: int
    allowed: float
    after: float | None


def measure_adaptations(
    environment: DemoEnvironment, pipeline: InstrumentationPipeline, seeds: Sequence[int]
) -> list[SlowdownResult]:
    """Halve the recogniser's rate in each world while the robot cruises through a corridor.

    The app that the pipeline has scanned is guarded as in the RSR case: no pedestrian and no light
    slows the robot here, only the guard. SourceError if the robot never cruises.
    """
    scene = make_scene(GR.name, seeds[0])
    setting = RunConditions(scene=scene, speed=environment.speed, rate=RATE, window=WINDOW)
    launch = pipeline.instrument(RSR.decisions(setting))
    with launch_app(environment, launch, plan=pipeline.plan) as app:
        session = AppSession(environment, app, RATE)
        session.wait_until_connected()
        allowed = threshold(setting) * setting.wall_rate / 2 * _SPARE
        return [
            SlowdownResult(seed, allowed, _time_to_slow_down(session, seed, allowed))
            for seed in seeds
        ]


def _time_to_slow_down(session: AppSession, seed: int, allowed: float) -> float | None:
    """Return the wall s from the order to be slower to the first truth that is; None: never."""
    owner = session.environment.owner
    owner.set_image_rate(RATE)
    started = session.start_run(GR, seed, Variant.UNATTACKED)
    if _wait_for_truth(session, started, lambda truth: truth.velocity[0] >= _CRUISING) is None:
        raise SourceError(f"the robot does not get up to {_CRUISING:g} m/s")
    steady = owner.set_image_rate(RATE) + _STEADY
    _wait_for_truth(session, started, lambda truth: truth.t >= steady)
    ordered = time.monotonic()
    owner.set_image_rate(RATE / 2)
    slower = _wait_for_truth(session, started, lambda truth: truth.velocity[0] <= allowed)
    return None if slower is None else slower - ordered


def _wait_for_truth(
    session: AppSession, started: StartedRun, condition: Callable[[GroundTruth], bool]
) -> float | None:
    """Wait for a truth; return when it was heard (steady clock, s), None if it never was."""
    deadline = time.monotonic() + _LONGEST
    while time.monotonic() < deadline:
        if any(map(condition, session.new_truths(started.run))):
            return time.monotonic()
    return None
