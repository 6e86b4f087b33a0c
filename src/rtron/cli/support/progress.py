"""Progress on standard error: a bar where that is a terminal, else a line now and then."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from rtron.sources.static.common.scan_options import Progress as ProgressCallback

_MAX_SHOWN = 40
LINE_INTERVAL_S = 30.0
"""Seconds between two lines of progress where there is no terminal."""


@contextmanager
def show_progress() -> "Iterator[ProgressCallback]":
    """Yield a callback that shows the progress of a scan until the end of the block."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield progress_lines(lambda line: console.print(line, markup=False, soft_wrap=True))
        return
    parts = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*parts, console=console, transient=True, auto_refresh=False) as bar:
        task = bar.add_task("reading", total=None)

        def update(done: int, known: int, what: str) -> None:
            """Draw the bar; no thread does, since a process with threads cannot fork."""
            description = sanitize(what)[:_MAX_SHOWN]
            bar.update(task, completed=done, total=known, description=description, refresh=True)

        yield update


def progress_lines(
    print_line: Callable[[str], None], clock: Callable[[], float] = monotonic
) -> "ProgressCallback":
    """Return a callback that prints a line if the last one is LINE_INTERVAL_S ago; none at once."""
    last = clock()

    def update(done: int, known: int, what: str) -> None:
        nonlocal last
        if clock() - last >= LINE_INTERVAL_S:
            last = clock()
            print_line(f"{done} of {known}: {sanitize(what)}")

    return update


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
