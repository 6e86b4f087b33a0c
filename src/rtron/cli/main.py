"""The command `rtron`."""

import os
import sys
from io import TextIOWrapper
from typing import Annotated

import typer

from rtron import __version__
from rtron.cli.command_registry import CommandGroup
from rtron.cli.support.outcome import BAD_INPUT, Outcome, deliver, discard_output, print_error
from rtron.errors import RTronError

app = typer.Typer(
    name="rtron",
    cls=CommandGroup,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line and end with its exit code; the one place where errors are shown."""
    _open_standard_files()
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        app(prog_name="rtron")
    except RTronError as error:
        print_error(error)
        sys.exit(BAD_INPUT)
    except BrokenPipeError:  # of a usage message, which Click writes
        discard_output(sys.stdout)
        discard_output(sys.stderr)
        sys.exit(BAD_INPUT)


def _open_standard_files() -> None:
    """Let what the caller has closed (`>&-`) lead nowhere: its number would be another file's."""
    for descriptor, name in enumerate(("stdin", "stdout", "stderr")):
        if not _is_open(descriptor):
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # noqa: FBT003 - positional only
            mode = "w" if descriptor else "r"
            setattr(sys, name, open(descriptor, mode, encoding="utf-8", closefd=False))  # noqa: SIM115


def _is_open(descriptor: int) -> bool:
    try:
        os.fstat(descriptor)
    except OSError:
        return False
    return True


def _print_version(is_requested: bool) -> None:  # noqa: FBT001 - typer hands over the option's value
    if is_requested:
        deliver(Outcome(f"rtron {__version__}\n"))


@app.callback(result_callback=deliver)
def root(
    *,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Find what the nodes of a robot app can do to each other, and guard it.

    From an app to a guarded app:

    $ rtron scan src --launch pkg/app.launch     which nodes can interfere
    $ rtron plan src --launch pkg/app.launch -o rtron.yaml
    $ rtron check rtron.yaml               after you edited the plan
    $ rtron instrument app.launch --plan rtron.yaml -o guarded.launch
    $ rtron replay run.bag --plan rtron.yaml     try the plan on a recording
    $ roslaunch guarded.launch             the app, guarded
    $ rtron verify --live                  does all guarded traffic pass the guard?

    Completion of commands and names: rtron --install-completion
    """


_ROS_ARGS = "--ros-args"


def run_guard_node() -> None:
    """Run the guard without the arguments that ROS appends behind `--ros-args`."""
    arguments = sys.argv[1:]
    sys.argv[1:] = [
        "guard",
        *(arguments[: arguments.index(_ROS_ARGS)] if _ROS_ARGS in arguments else arguments),
    ]
    main()
