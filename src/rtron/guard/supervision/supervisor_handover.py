"""A guard that goes on without its supervisor, and the supervisor that takes it over.

The supervisor sends one line of JSON, `{"order": DIGEST}`, and gets one back: `{"answer": ...}`,
with the shared memory if it is `yes`. From then on the connection is what ties the two.
"""

import json
import os
import socket
import time
from collections.abc import Callable
from enum import Enum

from rtron.errors import SourceError
from rtron.guard.core.event_loop import Loop
from rtron.guard.supervision.guard_socket import guard_address, peer_of

LEAVE = b"L"
"""What a guard says to the supervisor whose place another one takes."""
BEGIN = b"B"
"""What a supervisor says to the guard that it has started, when it is to guard."""
_LONGEST = 1 << 10
_PATIENCE_S = 3.0
_PAUSE_S = 0.5
_RETRY_S = 0.05
_RETRIES = 20


class TakenError(SourceError):
    """There is another guard on the master."""


class Answer(Enum):
    """What a guard says to a supervisor that offers itself."""

    YES = "yes"
    SUPERVISED = "supervised"
    OTHER = "other"
    NONE = "none"


class Door:
    """Where supervisors offer themselves to a guard.

    `offered` takes the digest of a supervisor's order; it gives the answer, and the shared memory
    if that is yes. `taken` gets the connection then.
    """

    def __init__(
        self,
        loop: Loop,
        sock: socket.socket,
        offered: Callable[[str], tuple[Answer, int]],
        taken: Callable[[socket.socket], None],
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._offered = offered
        self._taken = taken
        loop.watch(sock, self._accept, lambda error: loop.pause(sock, _PAUSE_S))

    def close(self) -> None:
        """Be found no more."""
        self._loop.forget(self._sock)

    def _accept(self) -> None:
        caller, _ = self._sock.accept()
        caller.settimeout(0)
        if peer_of(caller)[1] == os.getuid():
            forget = self._loop.forget
            self._loop.watch(caller, lambda: self._answer(caller), lambda error: forget(caller))
        else:
            caller.close()

    def _answer(self, caller: socket.socket) -> None:
        digest = _request(caller.recv(_LONGEST))
        answer, page = self._offered(digest)
        line = json.dumps({"answer": answer.value}).encode() + b"\n"
        socket.send_fds(caller, [line], [page] if answer is Answer.YES else [])
        if answer is Answer.YES:
            taken = caller.dup()
            taken.settimeout(0)
            self._loop.forget(caller)
            self._taken(taken)
        else:
            self._loop.forget(caller)


def bound(master: str) -> socket.socket | None:
    """Return a socket at the guard's address; None if another user's process has it.

    TakenError if a guard of the same user is there.
    """
    for _ in range(_RETRIES):
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            sock.bind(guard_address(master))
            sock.listen()
            sock.settimeout(0)
            return sock
        except OSError:
            sock.close()
        holder = _holder(master)
        if holder and holder[1] != os.getuid():
            return None
        time.sleep(_RETRY_S)  # it may be dying
    raise TakenError(f"another guard is running on {master}", help="stop it first")


def offer(master: str, digest: str) -> tuple[Answer, int, socket.socket, int] | None:
    """Offer oneself to the guard on a master; None if there is none of this user.

    Returns its answer, its process, the connection and the shared memory (-1 if it gives none).
    """
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    sock.settimeout(_PATIENCE_S)
    try:
        sock.connect(guard_address(master))
    except OSError:
        sock.close()
        return None
    pid, uid = peer_of(sock)
    if uid != os.getuid():
        sock.close()
        return None
    answer, page = _ask(sock, digest)
    return answer, pid, sock, page


def _ask(sock: socket.socket, digest: str) -> tuple[Answer, int]:
    try:
        sock.sendall(json.dumps({"order": digest}).encode() + b"\n")
        line, pages, _, _ = socket.recv_fds(sock, _LONGEST, 1)
        answer = Answer(json.loads(line)["answer"])
    except (OSError, ValueError, LookupError, TypeError):
        return Answer.NONE, -1
    return answer, pages[0] if pages else -1


def _request(line: bytes) -> str:
    try:
        request = json.loads(line)
    except (ValueError, RecursionError):
        request = None
    return str(request.get("order")) if isinstance(request, dict) else ""


def _holder(master: str) -> tuple[int, int] | None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(0)
        try:
            sock.connect(guard_address(master))
        except OSError:
            return None
        return peer_of(sock)
