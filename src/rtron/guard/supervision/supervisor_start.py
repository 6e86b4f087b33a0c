"""From the command to the supervisor, and from it to the guard."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from rtron.guard.link.options import LinkOptions
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.programs import SUPERVISOR, command
from rtron.vocabulary import MeasuredRun, Plan


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
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, command(SUPERVISOR, [config_file]))  # noqa: S606 - our own Python
