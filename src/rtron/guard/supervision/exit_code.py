"""What a program without a command line says when it cannot start."""

import sys
from collections.abc import Callable

from rtron.errors import RTronError
from rtron.guard.supervision.supervisor_fsm import GUARD_EXISTS, REFUSED
from rtron.guard.supervision.supervisor_handover import GuardExistsError


def run_program(run: Callable[[], int]) -> int:
    """Return the exit code of `run`; if it fails, say why as the command line does."""
    try:
        return run()
    except RTronError as error:
        rows = [f"error: {error}", *([f"help: {error.help}"] if error.help else [])]
        sys.stderr.write("\n".join(rows) + "\n")
        return GUARD_EXISTS if isinstance(error, GuardExistsError) else REFUSED
