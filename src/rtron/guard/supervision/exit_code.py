"""What a program without a command line says when it cannot start."""

import sys
from collections.abc import Callable

from rtron.errors import RTronError
from rtron.guard.supervision.supervisor_fsm import REFUSED, TAKEN
from rtron.guard.supervision.supervisor_handover import TakenError


def complaining(run: Callable[[], int]) -> int:
    """Return the exit code of `run`; if it fails, say why as the command line does."""
    try:
        return run()
    except RTronError as error:
        rows = [f"error: {error}", *([f"help: {error.help}"] if error.help else [])]
        sys.stderr.write("\n".join(rows) + "\n")
        return TAKEN if isinstance(error, TakenError) else REFUSED
