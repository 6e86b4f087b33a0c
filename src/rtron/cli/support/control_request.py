"""A request to the control socket of a guard or a bridge on this machine."""

import json
import os
import socket
from pathlib import Path
from typing import Any

from rtron.errors import InputError, SourceError

_PATIENCE_S = 5.0
_LONGEST = 1 << 18


def send_request(path: Path, request: dict[str, object], who: str = "guard") -> dict[str, Any]:
    """Return the answer of `who` listens at a path.

    InputError if it refuses, SourceError if nobody answers.
    """
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
            sock.settimeout(_PATIENCE_S)
            sock.connect(str(path))
            _check_answerer(sock, path, who)
            sock.sendall(json.dumps(request).encode() + b"\n")
            answer = json.loads(sock.makefile("rb").readline(_LONGEST))
    except (OSError, ValueError) as error:
        help = f"is the {who} running, as your user? it says where it listens: `--control-socket`"
        raise SourceError(f"no {who} answers at {path}: {error}", help=help) from None
    if not isinstance(answer, dict) or "error" in answer:
        raise InputError(str(answer["error"]) if isinstance(answer, dict) else "not an answer")
    return answer


def _check_answerer(sock: socket.socket, path: Path, who: str) -> None:
    """SourceError if another user listens there, who could answer anything."""
    from rtron.guard.system.unix_socket import peer_credentials

    uid = peer_credentials(sock)[1]
    if os.getuid() not in (0, uid) and uid != 0:
        help = f"name the {who}'s own socket: `--control-socket`"
        raise SourceError(f"user {uid} listens at {path}, not you", help=help)
