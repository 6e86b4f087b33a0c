"""`rtron override`."""

import json
import socket
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import PlanOption
from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError, SourceError
from rtron.planning.plan_file.durations import parse_duration, write_duration
from rtron.planning.plan_file.loader import read_plan

_PATIENCE_S = 5.0
_LONGEST = 1 << 16


def override(
    id: Annotated[str, typer.Argument(metavar="ID", help="The coordination node: its plan `id`.")],
    *,
    plan: PlanOption,
    duration: Annotated[
        str, typer.Option("--for", metavar="TIME", help="How long: 30 s, 2 min; 0 ends it now.")
    ],
    reason: Annotated[str, typer.Option(metavar="TEXT", help="Why; it goes into the log.")] = "",
    control: Annotated[
        Path | None,
        typer.Option(metavar="SOCKET", help="Where the guard listens; its log says so."),
    ] = None,
) -> Outcome:
    """Let pass, for a while, what an RSRCN or MSRCN forbids.

    For the person beside the robot: docking, or driving out of an area that
    the robot must not enter. Who asked, why and for how long stands in the
    guard's log and diagnostics. What cannot be judged (NaN) and publishers
    that the plan does not know stay blocked. A restarted guard has forgotten
    it.

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
    answer = _send_request(control or control_path(read_plan(plan).app), request)
    if "error" in answer:
        raise InputError(str(answer["error"]))
    left = f"overridden for {write_duration(nanoseconds)}" if nanoseconds else "in force again"
    return Outcome(f"{id} is {left}\n")


def _send_request(path: Path, request: dict[str, object]) -> dict[str, object]:
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
            sock.settimeout(_PATIENCE_S)
            sock.connect(str(path))
            sock.sendall(json.dumps(request).encode() + b"\n")
            answer = json.loads(sock.makefile("rb").readline(_LONGEST))
    except (OSError, ValueError) as error:
        help = "is the guard running, as your user? `rtron guard` says where it listens"
        raise SourceError(f"no guard answers at {path}: {error}", help=help) from None
    return answer if isinstance(answer, dict) else {"error": "not an answer"}
