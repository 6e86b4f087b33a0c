"""A progress bar on standard error, where that is a terminal."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rtron.reports.sanitize import sanitize

if TYPE_CHECKING:
    from rtron.sources.static.common.scan_options import Progress as ProgressCallback

_MAX_SHOWN = 40


@contextmanager
def show_progress() -> "Iterator[ProgressCallback]":
    """Yield a callback that shows the progress of a scan until the end of the block."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    from rtron.sources.static.common.scan_options import ignore_progress

    console = Console(stderr=True)
    if not console.is_terminal:
        yield ignore_progress
        return
    parts = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn())
    with Progress(*parts, console=console, transient=True) as bar:
        task = bar.add_task("reading", total=None)

        def update(done: int, known: int, what: str) -> None:
            description = sanitize(what)[:_MAX_SHOWN]
            bar.update(task, completed=done, total=known, description=description)

        yield update


@contextmanager
def show_count(what: str) -> Iterator[Callable[[int], None]]:
    """Yield a callback that shows a growing number of `what`, whose total is unknown."""
    from rich.console import Console
    from rich.progress import Progress, TextColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done: None
        return
    with Progress(TextColumn("{task.completed:,.0f} {task.description}"), console=console) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done: bar.update(task, completed=done)
