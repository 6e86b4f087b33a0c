"""A demonstration: the app as it is and the guarded app, in a world, recorded by the service."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtron.demos.cases import Case
from rtron.demos.experiment.study import ProgressListener, Study
from rtron.demos.metrics.case_run import CaseRun, Variant
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.service import DemoService, run_service

FinishCallback = Callable[[Study, DemoService | None], None]
"""Takes what was found, while the service and the last guarded app still run.

The service is None where no guard was wanted.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoRequest:
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


def run_demo(
    request: DemoRequest, work_folder: Path, listener: ProgressListener, finish: FinishCallback
) -> None:
    """Run what is wished, in the folder `work_folder`, then `finish`; nothing is left running.

    SourceError if something that it needs is not there or ends; to be called in the main thread.
    """
    with demo_environment(request.ros, work_folder, speed=request.speed) as environment:
        study = Study(environment, request.cases, request.seeds, listener)
        if not request.guard:
            study.run_unguarded()
            finish(study, None)
            return
        with run_service(
            environment.processes, work_folder / "service", environment.environ
        ) as service:
            study.run_unguarded()
            with study.guarded_session(service):
                finish(study, service)


def are_as_expected(runs: Sequence[CaseRun]) -> bool:
    """Tell whether each attack was made and did harm without the guard, and all else went well."""
    return all(map(_as_expected, runs))


def _as_expected(run: CaseRun) -> bool:
    if run.is_attacked and not run.sent:
        return False
    if run.variant is Variant.ATTACKED:
        return bool(run.harm)
    return run.completed and not run.harm
