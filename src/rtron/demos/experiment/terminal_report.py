"""What a demonstration found, for a person at a terminal."""

from collections.abc import Iterator, Sequence

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from rtron.demos.cases import Case
from rtron.demos.experiment.demonstration import DemoRequest
from rtron.demos.experiment.study import Study
from rtron.demos.metrics.case_run import CaseRun
from rtron.demos.metrics.table import COLUMN_TITLES, cells, columns
from rtron.sanitize import sanitize
from rtron.vocabulary import Risk

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
