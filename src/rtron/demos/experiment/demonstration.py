"""A demonstration: the app as it is and the guarded app, in a world, recorded by the service."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from rtron.demos.cases import Case
from rtron.demos.experiment.study import ProgressListener, Study
from rtron.demos.metrics.case_run import CaseRun, Variant
from rtron.demos.metrics.table import COLUMN_TITLES, cells, columns
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.service import DemoService, run_service
from rtron.sanitize import sanitize
from rtron.vocabulary import Risk

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


_INDENT = (0, 0, 0, 2)


def demo_text(request: DemoRequest, study: Study) -> str:
    """Return the risks that the scan found, and a table for each case."""
    console = Console()
    with console.capture() as captured:
        console.print(Group(*_parts(request, study)))
    return captured.get()


def _parts(request: DemoRequest, study: Study) -> Iterator[RenderableType]:
    risks = study.risks()
    yield from _risks(risks)
    for case in request.cases:
        yield Text()
        yield Text(f"{case.title} (ROS {request.ros})", style="bold")
        yield from _story(case, risks, guarded=case.name in study.decisions)
        yield _table([run for run in study.runs if run.case == case.name])
        for seed, sentence in study.without_guard(case.name).items():
            text = f"without the guard, in world {seed}: {sentence}"
            yield Padding(Text(sanitize(text)), _INDENT)


def _risks(risks: Sequence[Risk]) -> Iterator[RenderableType]:
    yield Text(f"rtron scan finds {len(risks)} risks", style="bold")
    for risk in risks:
        yield Padding(Text(sanitize(risk.id)), _INDENT)


def _story(case: Case, risks: Sequence[Risk], *, guarded: bool) -> Iterator[RenderableType]:
    found = [risk.reason for risk in risks if risk.id == case.risk]
    sections = {
        "risk": "".join(found),
        "attack": case.attack,
        "guard": case.remedy if guarded else "",
    }
    for name, text in sections.items():
        if text:
            yield Padding(Text(f"{name}: {sanitize(text)}"), _INDENT)


def _table(runs: Sequence[CaseRun]) -> Table:
    found = columns(runs)
    table = Table("")
    for variant in found:
        table.add_column(COLUMN_TITLES[variant], justify="right")
    for title, values in cells(found):
        table.add_row(title, *values)
    return table
