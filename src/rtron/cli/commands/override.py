"""`rtron override` and `rtron clear`: what a person asks of a guard on this machine."""

import json
import os
import socket
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import PlanOption
from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError, SourceError

_PATIENCE_S = 5.0
_LONGEST = 1 << 16

ControlSocketOption = Annotated[
    Path | None,
    typer.Option(metavar="SOCKET", help="The control socket of the guard, as in its log."),
]


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
    from rtron.guard.core.control_socket import control_path
    from rtron.planning.plan_file.durations import parse_duration, write_duration
    from rtron.planning.plan_file.loader import read_plan

    try:
        nanoseconds = parse_duration(duration)
    except ValueError as error:
        raise InputError(f"--for: {error}") from None
    request = {"override": id, "duration": nanoseconds, "reason": reason}
    _send_request(control_socket or control_path(read_plan(plan).app), request)
    left = f"overridden for {write_duration(nanoseconds)}" if nanoseconds else "active again"
    return Outcome(f"{id} is {left}\n")


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
    from rtron.guard.core.control_socket import control_path
    from rtron.planning.plan_file.loader import read_plan

    request: dict[str, object] = {"clear": topic, "reason": reason}
    answer = _send_request(control_socket or control_path(read_plan(plan).app), request)
    cleared = answer.get("cleared")
    names = ", ".join(map(str, cleared)) if isinstance(cleared, list) else ""
    return Outcome(f"{names}: cleared, the robot may drive again\n")


def _check_answerer(sock: socket.socket, path: Path) -> None:
    """SourceError if another user listens there, who could answer anything."""
    from rtron.guard.system.unix_socket import peer_credentials

    uid = peer_credentials(sock)[1]
    if os.getuid() not in (0, uid) and uid != 0:
        help = "name the guard's own socket: `--control-socket`"
        raise SourceError(f"user {uid} listens at {path}, not you", help=help)


def _send_request(path: Path, request: dict[str, object]) -> dict[str, object]:
    """Return the guard's answer; InputError if it refuses, SourceError if no guard answers."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
            sock.settimeout(_PATIENCE_S)
            sock.connect(str(path))
            _check_answerer(sock, path)
            sock.sendall(json.dumps(request).encode() + b"\n")
            answer = json.loads(sock.makefile("rb").readline(_LONGEST))
    except (OSError, ValueError) as error:
        help = "is the guard running, as your user? it says where it listens: `--control-socket`"
        raise SourceError(f"no guard answers at {path}: {error}", help=help) from None
    if not isinstance(answer, dict) or "error" in answer:
        raise InputError(str(answer["error"]) if isinstance(answer, dict) else "not an answer")
    return answer
