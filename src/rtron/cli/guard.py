"""`rtron guard`."""

import logging
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.assignments import assignments
from rtron.cli.options import DEFAULT_MASTER, Master, PlanOption
from rtron.cli.outcome import Outcome
from rtron.planning.read import read_plan


class LogLevel(str, Enum):
    """How much the guard says on standard error."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


def guard(
    appended: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME:=VALUE", help="What roslaunch appends; accepted, not used."),
    ] = None,
    *,
    plan: PlanOption,
    master: Master = DEFAULT_MASTER,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Let everything pass; report what would be done.")
    ] = False,
    control: Annotated[
        Path | None,
        typer.Option(metavar="SOCKET", help="Where to listen for `rtron override`."),
    ] = None,
    log_level: Annotated[LogLevel, typer.Option(help="How much to log.")] = LogLevel.INFO,
) -> Outcome:
    """Stand between the app's nodes, as the plan says, until stopped.

    The guarded launch starts it. Start it by hand to try a plan out, or to
    watch with a plan whose coordination nodes all observe.

    $ rtron guard --plan rtron.yaml
    $ rtron guard --plan rtron.yaml --dry-run
    $ rtron guard --plan rtron.yaml --master http://robot:11311 --log-level debug

    A master that does not answer is waited for. A dry run stands in the flows
    but forbids nothing: diagnostics and log tell what would have been stopped.

    Exit code: 0 stopped, 2 bad plan.
    """
    from rtron.guard.run import run_guard  # noqa: PLC0415 - no other command needs a guard

    assignments(appended or ())
    logging.basicConfig(level=log_level.value.upper(), format="%(levelname)s %(message)s")
    return Outcome("", run_guard(read_plan(plan), master, dry_run=dry_run, control=control))
