"""`rtron clear`."""

from typing import Annotated

import typer

from rtron.cli.support.guard_socket import ControlSocketOption, send_request
from rtron.cli.support.options import PlanOption
from rtron.cli.support.outcome import Outcome
from rtron.planning.plan_file.loader import read_plan


def clear(
    topic: Annotated[
        str, typer.Argument(metavar="TOPIC", help="The guarded topic; without it, all of them.")
    ] = "",
    *,
    plan: PlanOption,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")],
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Let the robot drive again after an intrusion.

    A guard with `on_foreign: stop` stops what an intruder can move, and keeps
    it stopped when the intruder is gone, until a person clears it. Find out
    first who it was: the guard's log and diagnostics name it. The guard logs
    your user name and the reason. It refuses while the intruder is there.

    $ rtron clear /cmd_vel --reason "a forgotten rostopic pub" --plan rtron.yaml

    Exit code: 0 cleared, 2 not.
    """
    from rtron.guard.core.control_socket import control_path  # noqa: PLC0415 - no other command needs a guard

    request: dict[str, object] = {"clear": topic, "reason": reason}
    answer = send_request(control_socket or control_path(read_plan(plan).app), request)
    cleared = answer.get("cleared")
    names = ", ".join(map(str, cleared)) if isinstance(cleared, list) else ""
    return Outcome(f"{names}: cleared, the robot may drive again\n")
