"""`python -m evaluation [PART ...] [-v]`: evaluate all parts, or those that are named."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from evaluation.common import demos, findings, functions, graph_truths, movers
from evaluation.common.datasets import (
    Datasets,
    MissingDatasetError,
    Part,
    Reporter,
    datasets_from_environ,
)
from evaluation.ros1 import autorace, autoware, calls, launch_files
from evaluation.ros1.systems import AUTORALLY, TURTLEBOT, part
from evaluation.ros2 import autoware_universe, navigation2
from evaluation.ros2 import launch_files as ros2_launch_files
from figures.figure import Figure
from figures.table import table, write

PARTS: dict[str, Part] = {
    "autorally": part(AUTORALLY),
    "turtlebot": part(TURTLEBOT),
    "autorace": autorace.figures,
    "autoware": autoware.figures,
    "calls": calls.figures,
    "launches": launch_files.figures,
    "launch2": ros2_launch_files.figures,
    "nav2": navigation2.figures,
    "universe": autoware_universe.figures,
    "graphs": graph_truths.figures,
    "functions": functions.figures,
    "findings": findings.judged,
    "bugs": findings.bugs,
    "movers": movers.figures,
    "demos": demos.figures,
}
OUTPUT = Path(__file__).parents[1] / "build" / "eval.json"


def main() -> None:
    """Evaluate, write the JSON, print the tables."""
    args = _arguments()
    console = Console(width=None if sys.stdout.isatty() else 110)
    found: list[Figure] = []
    with _progress(console) as progress:
        reporter = _reporter(console, progress, verbose=args.verbose)
        for figure in _evaluated(datasets_from_environ(), args.parts or list(PARTS), reporter):
            found.append(figure)
            write(found, args.output, keep=bool(args.parts))
    console.print(table("RTron beside its peers", found))
    console.print(f"written to {args.output}")


def _evaluated(datasets: Datasets, names: Sequence[str], reporter: Reporter) -> Iterator[Figure]:
    for name in names:
        yield from _figures(name, datasets, reporter)


def _figures(name: str, datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    try:
        yield from PARTS[name](datasets, reporter)
    except MissingDatasetError as error:
        reporter.lines([f"{name} is skipped: {error}", ""])


def _reporter(console: Console, progress: Progress, *, verbose: bool) -> Reporter:
    task = progress.add_task("")

    def show_activity(what: str) -> None:
        progress.update(task, description=what, refresh=True)

    def print_lines(lines: Sequence[str]) -> None:
        for line in lines:
            console.print(line, markup=False, highlight=False, soft_wrap=True)

    return Reporter(show_activity, print_lines, print_lines if verbose else _quiet)


def _quiet(lines: Sequence[str]) -> None:
    """Take lines that nobody asked for."""


def _progress(console: Console) -> Progress:
    """Return what shows the activity; no thread draws it, so that scans may fork."""
    description = TextColumn("{task.description}")
    return Progress(
        SpinnerColumn(), description, TimeElapsedColumn(), console=console, auto_refresh=False
    )


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m evaluation", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("-v", "--verbose", action="store_true", help="list what is wrong")
    parser.add_argument("-o", "--output", type=Path, default=OUTPUT, help="the JSON file")
    args = parser.parse_args()
    if unknown := set(args.parts) - set(PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    return args


if __name__ == "__main__":
    main()
