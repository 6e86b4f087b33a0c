"""How the guard and the supervisor are started: small processes that share what they import.

A program is `python -c` with the module path of the process that starts it: it runs the same code,
whatever lies in the folder where it is started, and needs nothing of the command line.
"""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, NoReturn

from rtron.errors import RTronError
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.supervisor_fsm import REFUSED

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from rtron.guard.link.options import LinkOptions
    from rtron.vocabulary import MeasuredRun, Plan

_CODE = (
    "import gc, sys; gc.disable(); sys.path[:] = sys.argv[3:]; "
    "from rtron.guard.supervision.{module} import {function}; gc.enable(); {function}(sys.argv[2])"
)
"""While modules are loaded nothing is garbage, and a quarter of the time went into the search."""
GUARD = "guard_program:main"
SUPERVISOR = "supervisor_program:main"
BULK = "bulk_program:main"
LINK = "link_program:main"
INCIDENTS = "incident_program:main"
TERMINATION_SIGNALS = (signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
"""What a terminal says to all of us when we are to end."""
JOB_CONTROL_SIGNALS = (signal.SIGTSTP, signal.SIGTTIN, signal.SIGTTOU)
"""What would freeze all of us at once, while the robot drives on: nobody hears it."""
TERMINAL_SIGNALS = frozenset(TERMINATION_SIGNALS + JOB_CONTROL_SIGNALS)


def command(entry_point: str, descriptors: Sequence[int]) -> list[str]:
    """Return the command of a program that inherits open files."""
    module, _, function = entry_point.partition(":")
    code = _CODE.format(module=module, function=function)
    numbers = ",".join(map(str, descriptors))
    return [sys.executable, "-c", code, f"rtron-{module}", numbers, *filter(None, sys.path)]


def process_name(entry_point: str) -> str:
    """Return what `ps -o comm` calls the process of a program."""
    return f"rtron-{entry_point.partition(':')[0].removesuffix('_program')}"


def start_program(entry_point: str, files: Sequence[int]) -> subprocess.Popen[bytes]:
    """Start a program that inherits open files, and hears no terminal before `leave_terminal`.

    OSError if the system cannot start it.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, TERMINAL_SIGNALS)
    try:
        return subprocess.Popen(command(entry_point, files), pass_fds=files)  # noqa: S603
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def leave_terminal() -> None:
    """Leave to the supervisor what a terminal says to all of us, as Ctrl-C and its end."""
    for number in TERMINAL_SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, TERMINAL_SIGNALS)


def open_descriptors(numbers: str) -> list[int]:
    """Return the open files that this program was given; it does not hand them on by itself."""
    opened = [int(number) for number in numbers.split(",")]
    for descriptor in opened:
        os.set_inheritable(descriptor, False)  # noqa: FBT003 - positional only
    return opened


def run_program(run: Callable[[], int]) -> int:
    """Return the exit code of `run`; if it fails, say why as the command line does."""
    try:
        return run()
    except RTronError as error:
        rows = [f"error: {error}", *([f"help: {error.help}"] if error.help else [])]
        sys.stderr.write("\n".join(rows) + "\n")
        return REFUSED


def supervise(
    plan: Plan,
    master: str,
    *,
    log_level: str,
    dry_run: bool = False,
    control: Path | None = None,
    figures: Callable[[MeasuredRun], None] | None = None,
    link: LinkOptions | None = None,
) -> NoReturn:
    """Become the supervisor of a guard that is told what `run_guard` is.

    The process is the same, but forgets everything it has imported so far.
    """
    options = {"dry_run": dry_run, "control": control, "figures": figures, "link": link}
    config_file = GuardConfig(
        plan=plan, master=master, log_level=log_level, options=options
    ).write_to_memory()
    os.set_inheritable(config_file, True)  # noqa: FBT003 - positional only
    logging.shutdown()
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, command(SUPERVISOR, [config_file]))  # noqa: S606 - our own Python
