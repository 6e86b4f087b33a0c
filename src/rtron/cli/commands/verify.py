"""`rtron verify`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import (
    DEFAULT_MASTER,
    DEFAULT_TIMEOUT,
    Domain,
    Master,
    RosOption,
    TextOrJson,
    Timeout,
)
from rtron.cli.support.outcome import BAD_INPUT, FINDINGS, OK, Outcome, as_json
from rtron.errors import InputError
from rtron.workflows.live_app import RosGeneration

Live = Annotated[bool, typer.Option("--live", help="Verify the running app.")]


def verify(  # noqa: PLR0913 - one for each option
    *,
    live: Live = False,
    plan: Annotated[
        Path, typer.Option("--plan", metavar="rtron.yaml", help="The plan of the guarded app.")
    ] = Path("rtron.yaml"),
    master: Master = DEFAULT_MASTER,
    ros: RosOption = RosGeneration.AUTO,
    domain: Domain = None,
    timeout: Timeout = DEFAULT_TIMEOUT,
    absent: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="A node of the plan that is switched off, `*` for what changes; can be repeated.",
        ),
    ] = None,
    keystore: Annotated[
        Path | None,
        typer.Option(
            metavar="KEYSTORE",
            help="Join with the enclave /rtron_verify of this keystore, and try what SROS2 keeps "
            "out (ROS 2).",
        ),
    ] = None,
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Check that all guarded traffic of the running app passes through the guard.

    In ROS 1 it asks every guarded node for its connections, because a
    publisher that never registered shows nowhere else. In ROS 2 it reads the
    endpoints of the domain and their participants; `--timeout` is how long
    discovery may take. States of the paths of the plan:

    closed        the node receives from the guard only, on the private topic
    open          the node also receives from another publisher, which is named
    drift         the node uses the public name: its remap is missing
    unknown       the node runs, and does not answer or is not connected
    not seen      the node was not found: it may run where nobody looked
    absent        the same, and you said so with --absent

    $ rtron verify --live
    $ rtron verify --live --plan rtron.yaml --master http://robot:11311
    $ rtron verify --live --ros 2 --domain 7        a plan that says `ros: 2`
    $ rtron verify --live --absent /teleop          teleop is switched off
    $ rtron verify --live --keystore keystore       SROS2 is in force, too
    $ rtron verify --live --format json | jq .verdict

    With --keystore nobody may be there without a certificate, and an enclave
    other than the guard's may not publish what the base reads: both are tried.

    It changes nothing; in ROS 2 it joins the domain as /rtron_verify. The
    running guard checks the same continuously; see `audit` in the plan.

    Exit code: 0 closed, 1 open or drifted, 2 unknown or not seen.
    """
    from rtron.planning.plan_file.loader import read_plan
    from rtron.reports.plan.verification import verification_text, verification_to_json
    from rtron.workflows.live_app import verify_running_app

    if not live:
        help = "add --live; before the app runs, `rtron check` compares the plan with its graph"
        raise InputError("`rtron verify` needs --live", help=help)
    guard_plan = read_plan(plan)
    _check_generation(ros, guard_plan.ros, str(plan))
    verification = verify_running_app(
        guard_plan, master, domain, timeout, absent=absent or (), keystore=keystore
    )
    code = OK if verification.is_closed else FINDINGS if verification.is_conclusive else BAD_INPUT
    if format is TextOrJson.JSON:
        return Outcome(as_json(verification_to_json(verification)), code)
    return Outcome(verification_text(str(plan), verification), code)


def _check_generation(ros: RosGeneration, of_plan: int, plan: str) -> None:
    """Raise InputError if a person asks for another ROS than the plan's, which decides."""
    if ros is not RosGeneration.AUTO and int(ros.value) != of_plan:
        help = "leave --ros out, or give the plan of that app with --plan"
        raise InputError(f"says `ros: {of_plan}`, not {ros.value}", path=plan, help=help)
