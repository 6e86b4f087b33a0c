"""Requests to a guard on this machine, through its control socket."""

import json
import socket
from pathlib import Path
from typing import Annotated

import typer

from rtron.errors import InputError, SourceError

_PATIENCE_S = 5.0
_LONGEST = 1 << 16

ControlSocketOption = Annotated[
    Path | None,
    typer.Option(metavar="SOCKET", help="The control socket of the guard, as in its log."),
]


def send_request(path: Path, request: dict[str, object]) -> dict[str, object]:
    """Return the guard's answer; InputError if it refuses, SourceError if no guard answers."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
            sock.settimeout(_PATIENCE_S)
            sock.connect(str(path))
            sock.sendall(json.dumps(request).encode() + b"\n")
            answer = json.loads(sock.makefile("rb").readline(_LONGEST))
    except (OSError, ValueError) as error:
        help = "is the guard running, as your user? `rtron guard` says where it listens"
        raise SourceError(f"no guard answers at {path}: {error}", help=help) from None
    if not isinstance(answer, dict) or "error" in answer:
        raise InputError(str(answer["error"]) if isinstance(answer, dict) else "not an answer")
    return answer
