"""`rtron override`."""

from typing import Annotated

import typer

from rtron.cli.support.guard_socket import ControlSocketOption, send_request
from rtron.cli.support.options import PlanOption
from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError
from rtron.planning.plan_file.durations import parse_duration, write_duration
from rtron.planning.plan_file.loader import read_plan


def override(
    id: Annotated[str, typer.Argument(metavar="ID", help="The coordination node: its plan `id`.")],
    *,
    plan: PlanOption,
    duration: Annotated[
        str,
        typer.Option("--for", metavar="TIME", help="Duration: 30 s, 2 min; 0 cancels it."),
    ],
    reason: Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")] = "",
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Suspend an RSRCN or MSRCN for a limited time.

    For a person beside the robot, who docks it or drives it out of a forbidden
    area. The guard logs the user, the reason and the duration, and shows them
    in its diagnostics. Invalid values (NaN) and publishers that are not in the
    plan stay blocked. A restart of the guard ends the override.

    $ rtron override rsrcn --for 30s --reason docking --plan rtron.yaml
    $ rtron override rsrcn --for 0 --plan rtron.yaml

    Exit code: 0 granted, 2 not.
    """
    from rtron.guard.core.control_socket import control_path  # noqa: PLC0415 - no other command needs a guard

    try:
        nanoseconds = parse_duration(duration)
    except ValueError as error:
        raise InputError(f"--for: {error}") from None
    request = {"override": id, "duration": nanoseconds, "reason": reason}
    send_request(control_socket or control_path(read_plan(plan).app), request)
    left = f"overridden for {write_duration(nanoseconds)}" if nanoseconds else "active again"
    return Outcome(f"{id} is {left}\n")
