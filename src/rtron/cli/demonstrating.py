"""What `rtron demo` needs around it: packages, a ROS, a folder, a bar, the console at the end."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from rtron.cli.options import Ros
from rtron.cli.outcome import tell
from rtron.cli.serving import need_service
from rtron.errors import InputError, SourceError

if TYPE_CHECKING:
    from rtron.demos.launching.service import Service
    from rtron.demos.measuring.run import Run
    from rtron.demos.running.wanted import Tell

_NEEDED = ("irsim", "matplotlib", "numpy", "shapely")
_NO_ROS = "`make setup` in a checkout installs one"


def need_demo() -> None:
    """Raise InputError if the packages of the demo, or of the service, are not installed."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        help = 'pip install "rtron[demo]"'
        raise InputError(f"the demo needs {', '.join(missing)}", help=help)
    need_service()


def chosen_ros(ros: Ros) -> int:
    """Return the ROS to run on: the one asked for, or else what is there, ROS 2 first."""
    from rtron.demos.launching.surroundings import lacking, need  # noqa: PLC0415 - the guard starts without it

    if ros is not Ros.AUTO:
        need(int(ros.value))
        return int(ros.value)
    lacks = lacking()
    present = [number for number in (2, 1) if not lacks[number]]
    if not present:
        raise SourceError("; ".join(lacks[number] for number in (2, 1)), help=_NO_ROS)
    return present[0]


def results_folder(out: Path) -> Path:
    """Return the folder for the results, made if it is not there; InputError if it cannot be."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        help = "choose a folder with -o"
        raise InputError(error.strerror or "cannot be made", path=str(out), help=help) from None
    return out


@dataclass(frozen=True, slots=True)
class Shown:
    """What shows how far a demonstration is, until it is stopped."""

    tell: "Tell"
    bar: Progress

    def stop(self) -> None:
        """Show it no more."""
        self.bar.stop()


@contextmanager
def shown_progress(runs: int) -> Iterator[Shown]:
    """Show on standard error what happens now, and how many of the runs are done.

    Nothing is shown where that is no terminal.
    """
    from rtron.demos.running.wanted import Tell  # noqa: PLC0415 - only with the extra

    console = Console(stderr=True)
    parts = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn())
    hidden = not console.is_terminal
    with Progress(
        *parts, TimeElapsedColumn(), console=console, transient=True, disable=hidden
    ) as bar:
        task = bar.add_task("starting the world", total=runs)

        def now(what: str) -> None:
            bar.update(task, description=what)

        def done(_: "Run") -> None:
            bar.advance(task)

        yield Shown(Tell(now, done), bar)


def show_console(service: "Service") -> None:
    """Say where the console is and how to log in, and wait there for Ctrl-C."""
    tell(f"\nThe console: {service.url}/  user admin, password {service.password}\n")
    tell("Ctrl-C ends it.\n")
    with suppress(KeyboardInterrupt):
        threading.Event().wait()
