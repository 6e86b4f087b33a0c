"""The case studies: each in twenty worlds, without an attack, attacked, and guarded."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from evaluation.common.datasets import Datasets, MissingDatasetError
from evaluation.demo_runs import runs_page
from evaluation.part import Reporter
from figures.figure import Figure
from rtron.demos.cases import CASES
from rtron.demos.experiment.adaptation import SlowdownResult, measure_adaptations
from rtron.demos.experiment.demonstration import DemoRequest, run_demo
from rtron.demos.experiment.study import Study
from rtron.demos.experiment.wanted import ProgressListener as TellStudy
from rtron.demos.metrics.case_run import CaseRun, Variant
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.runtime.ros_installation import missing_requirements

WORLDS = 20
SPEED = 3.0
PAGE = Path(__file__).parents[1] / "build" / "demo_runs.md"
_SLOWER = 1.05
_ADAPTS = 0.5
_ENOUGH = 19
_SEEDS = range(1, WORLDS + 1)


def figures(_datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Run all cases on each ROS that is there, and write the page of all runs."""
    present = [ros for ros, lacks in missing_requirements().items() if not lacks]
    if not present:
        raise MissingDatasetError("there is neither ROS 1 nor ROS 2")
    runs: list[CaseRun] = []
    slowed: dict[int, list[SlowdownResult]] = {}
    for ros in present:
        ros_runs = _studied(ros, reporter)
        runs += ros_runs
        yield from _of_ros(ros, ros_runs)
        reporter.progress(f"ROS {ros}: how soon the robot adapts")
        slowed[ros] = _adapted(ros)
        yield from figures_of_adaptations(ros, slowed[ros])
        PAGE.parent.mkdir(parents=True, exist_ok=True)
        PAGE.write_text(runs_page(runs, slowed), encoding="utf-8")


def _studied(ros: int, reporter: Reporter) -> list[CaseRun]:
    found: list[CaseRun] = []

    def now(what: str) -> None:
        reporter.progress(f"ROS {ros}: {what}")

    def done(run: CaseRun) -> None:
        reporter.detail([f"ROS {ros}, {run.case}, world {run.seed}, {run.variant}: {run.outcome}"])

    def finish(study: Study, _service: object) -> None:
        found.extend(study.runs)

    for case in CASES.values():  # each guarded by its own decisions alone
        wish = DemoRequest(cases=[case], seeds=_SEEDS, ros=ros, speed=SPEED)
        with TemporaryDirectory(prefix="rtron-demo-") as work:
            run_demo(wish, Path(work), TellStudy(now, done), finish)
    return found


def _adapted(ros: int) -> list[SlowdownResult]:
    """Return the adaptations at speed 1, in which the guard's time is that of the robot."""
    with (
        TemporaryDirectory(prefix="rtron-demo-") as work,
        demo_environment(ros, Path(work)) as environment,
    ):
        pipeline = InstrumentationPipeline(environment, Path(work))
        pipeline.scan()
        return measure_adaptations(environment, pipeline, _SEEDS)


def _of_ros(ros: int, runs: Sequence[CaseRun]) -> Iterator[Figure]:
    for case in CASES:
        yield from figures_of_case(
            f"demo.ros{ros}.{case}", [run for run in runs if run.case == case]
        )


def figures_of_case(name: str, runs: Sequence[CaseRun]) -> Iterator[Figure]:
    """Yield the figures of the runs of a case."""
    calm, attacked, guarded = (
        [run for run in runs if run.variant is variant] for variant in Variant
    )
    ratios = list(_ratios(calm, guarded))
    yield Figure(f"{name}.harmed", _harmed(attacked), None, "of 20", at_least=_ENOUGH)
    collided = sum(run.collided for run in attacked)
    yield Figure(f"{name}.collided", collided, None, "of 20")
    yield Figure(f"{name}.guarded.attacked", _attacked(guarded), None, "of 20", at_least=_ENOUGH)
    yield Figure(f"{name}.guarded.harmed", _harmed(guarded), None, "of 20", at_most=0)
    completed = sum(run.completed for run in guarded)
    yield Figure(f"{name}.guarded.completed", completed, None, "of 20", at_least=_ENOUGH)
    delivered = sum(run.delivered for run in guarded)
    yield Figure(f"{name}.guarded.delivered", delivered, None, "messages", at_most=0)
    late = sum(ratio > _SLOWER for ratio in ratios)
    yield Figure(f"{name}.guarded.slower", late, None, "of 20", at_most=WORLDS - _ENOUGH)
    worst = max(ratios, default=0.0) - 1
    yield Figure(f"{name}.guarded.slowest", worst, None, "share more")


def _ratios(calm: Sequence[CaseRun], guarded: Sequence[CaseRun]) -> Iterator[float]:
    """Yield how long each guarded run took, where it arrived, as a multiple of the calm one."""
    times = {run.seed: run.time_to_goal for run in calm}
    for run in guarded:
        usual = times.get(run.seed)
        if usual and run.time_to_goal:
            yield run.time_to_goal / usual


def _attacked(runs: Sequence[CaseRun]) -> int:
    return sum(bool(run.sent) for run in runs)


def _harmed(runs: Sequence[CaseRun]) -> int:
    return sum(bool(run.harm) for run in runs)


def figures_of_adaptations(ros: int, found: Sequence[SlowdownResult]) -> Iterator[Figure]:
    """Yield how many adaptations came soon enough, and the slowest."""
    times = [each.after for each in found if each.after is not None]
    soon = sum(time <= _ADAPTS for time in times)
    name = f"demo.ros{ros}.rsr.adapts"
    yield Figure(name, soon, None, "of 20", at_least=WORLDS)
    worst = max(times, default=float("inf")) if len(times) == len(found) else float("inf")
    yield Figure(f"{name}.slowest", worst, None, "s", at_most=_ADAPTS)
