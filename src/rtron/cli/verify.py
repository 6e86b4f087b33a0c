"""`rtron verify`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.options import DEFAULT_MASTER, DEFAULT_TIMEOUT, Master, TextOrJson, Timeout
from rtron.cli.outcome import BAD_INPUT, FOUND, OK, Outcome, as_json
from rtron.cli.verified import verified_json, verified_text
from rtron.errors import InputError, PlanError
from rtron.planning.read import read_plan

Live = Annotated[bool, typer.Option("--live", help="Verify the app that is running.")]


def verify(
    *,
    live: Live = False,
    plan: Annotated[
        Path, typer.Option("--plan", metavar="rtron.yaml", help="The plan of the guarded app.")
    ] = Path("rtron.yaml"),
    master: Master = DEFAULT_MASTER,
    timeout: Timeout = DEFAULT_TIMEOUT,
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Look whether the guard is really in the way of the app that is running.

    Every node behind the guard is asked who speaks to it, since a publisher
    that never registered shows nowhere else. For each path of the plan:

    closed        only the guard is heard, on the private topic
    open          somebody else is heard, too: it is named
    drift         the node uses the public name: its remap is missing
    unknown       the node runs and does not answer
    not running   nobody to be guarded

    $ rtron verify --live
    $ rtron verify --live --plan rtron.yaml --master http://robot:11311
    $ rtron verify --live --format json | jq .verdict

    It joins no graph and changes nothing. The running guard does the same by
    itself, 13 times a second; see `audit` in the plan.

    Exit code: 0 closed, 1 open or drifted, 2 it cannot be told.
    """
    from rtron.guard.audit.outside import verify_live  # noqa: PLC0415 - only who verifies needs it
    from rtron.guard.fence.place import private_master  # noqa: PLC0415

    if not live:
        help = "add --live; before the app runs, `rtron check` compares the plan with its graph"
        raise InputError("what is there to verify?", help=help)
    wanted = read_plan(plan)
    if wanted.ros != 1:
        help = "`rtron verify` speaks ROS 1 only"
        raise PlanError("the plan says `ros: 2`", path=str(plan), help=help)
    found = verify_live(wanted, private_master(master), timeout)
    code = OK if found.closed else FOUND if found.told else BAD_INPUT
    if format is TextOrJson.JSON:
        return Outcome(as_json(verified_json(found)), code)
    return Outcome(verified_text(str(plan), found), code)
