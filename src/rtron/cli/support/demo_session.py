"""What `rtron demo` needs around it: packages, a ROS, a folder, a bar, the console at the end."""

import os
import sys
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.cli.support.outcome import print_part
from rtron.cli.support.service_database import require_service_packages
from rtron.errors import InputError, SourceError
from rtron.workflows.live_app import RosGeneration

if TYPE_CHECKING:
    from rich.progress import Progress

    from rtron.demos.experiment.study import ProgressListener
    from rtron.demos.metrics.case_run import CaseRun
    from rtron.demos.runtime.service import DemoService

_NEEDED = ("irsim", "matplotlib", "numpy", "shapely")
_SCREENS = ("DISPLAY", "WAYLAND_DISPLAY")
_NO_ROS = "`make setup` in a checkout installs one"


def require_demo_packages() -> None:
    """Raise InputError if the packages of the demo, or of the service, are not installed."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        help = 'pip install "rtron[demo]"'
        raise InputError(f"the demo needs {', '.join(missing)}", help=help)
    require_service_packages()


def choose_ros(ros: RosGeneration) -> int:
    """Return the ROS to run on: the one asked for, or else what is there, ROS 2 first."""
    from rtron.demos.runtime.ros_installation import find_ros_python, missing_requirements

    if ros is not RosGeneration.AUTO:
        find_ros_python(int(ros.value))
        return int(ros.value)
    lacks = missing_requirements()
    present = [number for number in (2, 1) if not lacks[number]]
    if not present:
        raise SourceError("; ".join(lacks[number] for number in (2, 1)), help=_NO_ROS)
    return present[0]


@contextmanager
def preserve_logs(work: Path, out: Path) -> Iterator[None]:
    """Copy the logs from the folder of work to `out` if the block fails, and say where they are."""
    from rtron.demos.experiment.results_folder import copy_logs

    try:
        yield
    except SourceError as error:
        if logs := copy_logs(work, out, str(error)):
            sys.stderr.write(f"The logs are in {logs}\n")
        raise


@contextmanager
def show_demo_progress(runs: int) -> "Iterator[tuple[ProgressListener, Progress]]":
    """Show on standard error what happens now, and how many of the runs are done; give the bar.

    Nothing is shown where that is no terminal.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from rtron.demos.experiment.study import ProgressListener

    console = Console(stderr=True)
    parts = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn())
    hidden = not console.is_terminal
    with Progress(
        *parts, TimeElapsedColumn(), console=console, transient=True, disable=hidden
    ) as bar:
        task = bar.add_task("starting the world", total=runs)

        def now(what: str) -> None:
            bar.update(task, description=what)

        def done(_: "CaseRun") -> None:
            bar.advance(task)

        yield ProgressListener(now, done), bar


def show_console(service: "DemoService", *, to_stderr: bool = False) -> None:
    """Open the console, say where it is and how to log in, and wait there for Ctrl-C.

    `to_stderr`: on standard error, since standard output is for a program.
    """
    write = sys.stderr.write if to_stderr else print_part
    write(f"\nThe console: {service.page}\nuser admin, password {service.password}\n")
    write("The guarded app still runs there. Ctrl-C ends both.\n")
    if any(os.environ.get(screen) for screen in _SCREENS):
        webbrowser.open(service.page)
    with suppress(KeyboardInterrupt):
        threading.Event().wait()
