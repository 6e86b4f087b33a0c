"""The case studies: each in twenty worlds, without an attack, attacked, and guarded."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from evaluation.common.adaptation import SlowdownResult, measure_adaptations
from evaluation.common.datasets import Datasets, MissingDatasetError, Reporter
from figures.figure import Figure
from rtron.demos.cases import CASES
from rtron.demos.experiment.demonstration import DemoRequest, run_demo
from rtron.demos.experiment.study import ProgressListener as TellStudy
from rtron.demos.experiment.study import Study
from rtron.demos.metrics.case_run import CaseRun, Variant
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.runtime.ros_installation import missing_requirements

_HEAD = """\
# The case studies, run by run

`python -m evaluation demos` made these: every case in twenty worlds, in which start, goal, widths,
obstacles and the pedestrian's moment differ. Times are simulated seconds. The attack is `stopped`
where a verdict of the guard tells when; a flow that was blocked before gets no new one, and
`nothing arrived` is all that is to be told. `off` is the largest distance from the unattacked way.
"""
_COLUMNS = (
    "world | unattacked | attacked | collided | sent / delivered | guarded | time | "
    "sent / delivered | the attack | off"
)
_RULE = "--:|--:|---|---|--:|---|--:|--:|--:|--:"


def runs_page(runs: Sequence[CaseRun], slowed: Mapping[int, Sequence[SlowdownResult]]) -> str:
    """Return the page of all runs and adaptations."""
    return "\n".join((_HEAD, *_parts(runs), *_slowed(slowed))) + "\n"


def _parts(runs: Sequence[CaseRun]) -> Iterator[str]:
    for ros, case in dict.fromkeys((run.ros, run.case) for run in runs):
        case_runs = [run for run in runs if (run.ros, run.case) == (ros, case)]
        speed = f"{case_runs[0].speed:g} simulated seconds a second"
        yield f"## {case.upper()} on ROS {ros}, at {speed}\n"
        yield f"| {_COLUMNS} |\n|{_RULE}|"
        for seed in dict.fromkeys(run.seed for run in case_runs):
            yield _line({run.variant: run for run in case_runs if run.seed == seed})
        yield ""


def _line(runs: Mapping[Variant, CaseRun]) -> str:
    reference, attacked, guarded = (runs[variant] for variant in Variant)
    off = f"{guarded.deviation.largest:.2f} m" if guarded.deviation else ""
    cells = (
        str(reference.seed),
        _time(reference.time_to_goal),
        attacked.outcome,
        "yes" if attacked.collided else "no",
        f"{attacked.sent} / {attacked.delivered}",
        guarded.outcome,
        _time(guarded.time_to_goal),
        f"{guarded.sent} / {guarded.delivered}",
        guarded.mitigation,
        off,
    )
    return f"| {' | '.join(cells)} |"


def _time(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds:.1f} s"


def _slowed(slowed: Mapping[int, Sequence[SlowdownResult]]) -> Iterator[str]:
    for ros, found in slowed.items():
        yield f"## Safe on ROS {ros}: how soon the robot adapts\n"
        yield "The recogniser's rate is halved, from 20 to 10 images a second, while the robot"
        yield "cruises at speed 1; wall seconds until it is as slow as it may be then (10 % more"
        yield "counts as that). The guard counts frames over 0.2 s; the case itself runs with 10"
        yield "images a second and a window of four of them, and so adapts later.\n"
        yield "| world | after | at most |\n|--:|--:|--:|"
        for each in found:
            after = "never" if each.after is None else f"{each.after:.2f} s"
            yield f"| {each.seed} | {after} | {each.allowed:.3f} m/s |"
        yield ""


WORLDS = 20
SPEED = 3.0
PAGE = Path(__file__).parents[2] / "build" / "demo_runs.md"
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
