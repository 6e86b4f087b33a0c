"""A demonstration: the app as it is and the guarded app, in a world, recorded by the service."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtron.demos.cases import Case
from rtron.demos.experiment.study import Study
from rtron.demos.experiment.wanted import Tell, Wanted
from rtron.demos.metrics.case_run import Run, Variant
from rtron.demos.runtime.environment import begun
from rtron.demos.runtime.service import Service, served

Finish = Callable[[Study, Service | None], None]
"""Takes what was found, while the service and the last guarded app still run.

The service is None where no guard was wanted.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wish:
    """What to demonstrate on which ROS (1 or 2), at `speed` simulated s a wall s."""

    cases: Sequence[Case]
    seeds: Sequence[int]
    ros: int
    speed: float
    guard: bool = True

    @property
    def runs(self) -> int:
        """How many runs that takes."""
        variants = len(Variant) if self.guard else len(Variant) - 1
        return len(self.cases) * len(self.seeds) * variants


def demonstrate(wish: Wish, work: Path, tell: Tell, finish: Finish) -> None:
    """Run what is wished, in the folder `work`, then `finish`; nothing is left running.

    SourceError if something that it needs is not there or ends; to be called in the main thread.
    """
    with begun(wish.ros, work, speed=wish.speed) as surroundings:
        study = Study(surroundings, Wanted(cases=wish.cases, seeds=wish.seeds), tell)
        if not wish.guard:
            study.unguarded()
            finish(study, None)
            return
        with served(surroundings.processes, work / "service", surroundings.environ) as service:
            study.unguarded()
            with study.guarding(service):
                finish(study, service)


def as_expected(runs: Sequence[Run]) -> bool:
    """Tell whether each attack was made and did harm without the guard, and all else went well."""
    return all(map(_as_expected, runs))


def _as_expected(run: Run) -> bool:
    if run.attacked and not run.sent:
        return False
    if run.variant is Variant.ATTACKED:
        return bool(run.harm)
    return run.completed and not run.harm
