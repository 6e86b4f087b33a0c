"""`rtron demo`."""

import os
import sys
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from enum import Enum
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json, print_part
from rtron.cli.support.service_database import require_service_packages
from rtron.errors import InputError, SourceError
from rtron.workflows.live_app import RosGeneration

if TYPE_CHECKING:
    from rich.progress import Progress

    from rtron.demos.experiment.demonstration import DemoRequest
    from rtron.demos.experiment.study import ProgressListener, Study
    from rtron.demos.metrics.case_run import CaseRun
    from rtron.demos.runtime.service import DemoService

_SPEEDS = {"min": 0.25, "max": 8.0}


class CaseName(str, Enum):
    """A case study, or all of them."""

    GR = "gr"
    RSR = "rsr"
    MSR = "msr"
    AGENT = "agent"
    ALL = "all"


def demo(  # noqa: PLR0913 - one for each option
    case: Annotated[CaseName, typer.Argument(help="The case study, or all four.")],
    *,
    ros: Annotated[
        RosGeneration,
        typer.Option(help="Which ROS to run it on; auto takes what is there, 2 before 1."),
    ] = RosGeneration.AUTO,
    guard: Annotated[
        bool, typer.Option("--guard/--no-guard", help="Also run the guarded app.")
    ] = True,
    console: Annotated[
        bool, typer.Option("--console", help="Show the run in the console afterwards.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="The seed of the first world.")] = 1,
    runs: Annotated[int, typer.Option(min=1, metavar="N", help="The number of worlds.")] = 1,
    speed: Annotated[
        float, typer.Option(**_SPEEDS, metavar="X", help="Simulated seconds in a second.")
    ] = 2.0,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="The folder for the results.")
    ] = Path("rtron-demo"),
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Attack a simulated robot, without the guard and with it.

    Real ROS nodes drive a TurtleBot3 in a simulated world. In three cases two
    third-party packages are malicious, as in the paper; in the fourth an agent
    behind a bridge is talked into it:

    gr    one of two publishers of /cmd_vel turns the robot into a wall
    rsr   the maximal velocity is too high for the camera's frame rate
    msr   a malicious goal lies in an area without network
    agent it speeds into that area while a person drives; with its incident

    Each case runs without an attack, with it, and with attack and guard. The
    commands scan, plan and instrument add the guard; with `all`, one plan
    covers all four cases.

    $ rtron demo gr                        one case, half a minute
    $ rtron demo all --ros 1               all four, on ROS 1
    $ rtron demo rsr --no-guard            only the attack
    $ rtron demo msr --console             with the console
    $ rtron demo gr --runs 5 --seed 10     in worlds 10 to 14
    $ rtron demo all --format json         for a program

    It writes pictures, results.json, the plan and report.html over those of an
    earlier demo. Everything runs on this machine and ends with the command.

    Exit code: 0 the attacks harm only without the guard, and the guarded robot
    arrives; 1 otherwise; 2 bad options, or no ROS.
    """
    _check_options(guard=guard, console=console)
    from rtron.demos.cases import CASES
    from rtron.demos.experiment.demonstration import DemoRequest, are_as_expected, run_demo
    from rtron.demos.experiment.results import prepare_results_folder

    cases = list(CASES.values()) if case is CaseName.ALL else [CASES[case.value]]
    request = DemoRequest(
        cases=cases,
        seeds=range(seed, seed + runs),
        ros=choose_ros(ros),
        speed=speed,
        guard=guard,
    )
    out, runs_so_far = prepare_results_folder(output), []

    def finish(study: "Study", service: "DemoService | None") -> None:
        runs_so_far.extend(study.runs)
        bar.stop()
        _print_report(request, study, out, format)
        if console and service:
            show_console(service, to_stderr=format is TextOrJson.JSON)

    with (
        TemporaryDirectory(prefix="rtron-demo-") as folder,
        preserve_logs(Path(folder), out),
        show_demo_progress(request.runs) as (listener, bar),
    ):
        run_demo(request, Path(folder), listener, finish)
    return Outcome("", OK if are_as_expected(runs_so_far) else FINDINGS)


def _check_options(*, guard: bool, console: bool) -> None:
    """Raise InputError if the options do not go together, or packages are missing."""
    if console and not guard:
        help = "the console shows what the guard does: leave one of the two out"
        raise InputError("both --console and --no-guard are given", help=help)
    require_demo_packages()


def _print_report(request: "DemoRequest", study: "Study", out: Path, format: TextOrJson) -> None:
    from rtron.demos.experiment.demonstration import demo_text
    from rtron.demos.experiment.results import results_document, write_results

    written = write_results(out, request, study)
    if format is TextOrJson.JSON:
        print_part(as_json(results_document(request, study)))
    else:
        print_part(demo_text(request, study) + f"\nWritten to {out}: {', '.join(written)}\n")


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
    from rtron.demos.experiment.results import copy_logs

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
