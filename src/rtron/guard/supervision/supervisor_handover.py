"""A guard that goes on without its supervisor, and the supervisor that takes it over.

The supervisor sends one line of JSON, `{"config": DIGEST}`, and gets one back: `{"answer": ...}`,
with the shared memory if it is `yes`. From then on each notices by this connection when the other
ends.
"""

import json
import os
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from enum import Enum
from pathlib import Path

from rtron.errors import SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.system.unix_socket import abstract_address, peer_credentials, user_name


def guard_address(master: str) -> bytes:
    """Return the address of the guard on a master."""
    return abstract_address(user_name("guard", master.rstrip("/").encode()))


def is_running(pid: int) -> bool:
    """Tell whether a process is there and alive; one that we may not signal or look at is."""
    with suppress(PermissionError):  # it is another user's, and so it is there
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return False
    with suppress(OSError):  # without /proc a zombie counts as running
        return Path(f"/proc/{pid}/stat").read_bytes().rpartition(b") ")[2][:1] not in b"ZX"
    return True


HAND_OVER_MESSAGE = b"L"
"""What a guard sends to a supervisor that another one replaces."""
DISMISS_MESSAGE = b"D"
"""What a guard sends to a supervisor that it will not wait for any longer."""
WATCHING_MESSAGE = b"W"
"""What a supervisor sends to a guard that it has taken over, once it watches it."""
BEGIN = b"B"
"""What a supervisor sends to a guard that it has started, when it is to guard."""
_MAX_LINE_BYTES = 1 << 10
_TIMEOUT_S = 3.0
_PAUSE_S = 0.5
_RETRY_S = 0.05
_RETRIES = 20
_STOP_IT = "stop it first"


class GuardExistsError(SourceError):
    """There is another guard on the master."""


class HandoverAnswer(Enum):
    """What a guard answers to a supervisor that offers itself."""

    YES = "yes"
    SUPERVISED = "supervised"
    OTHER = "other"
    NONE = "none"


class HandoverSocket:
    """Where supervisors offer themselves to a guard.

    `on_offer` takes the digest of a supervisor's configuration and returns the answer, with the
    shared memory if that is yes. `on_accept` takes the connection then.
    """

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        on_offer: Callable[[str], tuple[HandoverAnswer, int]],
        on_accept: Callable[[socket.socket], None],
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._on_offer = on_offer
        self._on_accept = on_accept
        loop.watch(sock, self._accept_caller, lambda error: loop.suspend(sock, _PAUSE_S))

    def close(self) -> None:
        """Accept no offers any more."""
        self._loop.forget(self._sock)

    def _accept_caller(self) -> None:
        caller, _ = self._sock.accept()
        caller.settimeout(0)
        if _is_visible_and_ours(caller):
            forget = self._loop.forget
            self._loop.watch(caller, lambda: self._answer(caller), lambda error: forget(caller))
        else:
            caller.close()

    def _answer(self, caller: socket.socket) -> None:
        digest = _parse_digest(caller.recv(_MAX_LINE_BYTES))
        answer, memory = self._on_offer(digest)
        line = json.dumps({"answer": answer.value}).encode() + b"\n"
        socket.send_fds(caller, [line], [memory] if answer is HandoverAnswer.YES else [])
        if answer is HandoverAnswer.YES:
            connection = caller.dup()
            connection.settimeout(0)
            self._loop.forget(caller)
            self._on_accept(connection)
        else:
            self._loop.forget(caller)


def bind_guard_socket(master: str) -> socket.socket | None:
    """Return a socket at the guard's address; None if another process has it.

    That is one of another user, or one that is no guard: it does not listen. GuardExistsError if a
    guard of the same user is there.
    """
    holder: tuple[int, int] | None = None
    for _ in range(_RETRIES):
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            sock.bind(guard_address(master))
            sock.listen()
            sock.settimeout(0)
            return sock
        except OSError:
            sock.close()
        holder = _peer_at(master)
        if holder and holder[1] != os.getuid():
            return None
        time.sleep(_RETRY_S)  # it may be dying
    if holder is None:
        return None
    pid = holder[0] or "unknown, in another container or too busy to tell"
    raise GuardExistsError(f"another guard is running on {master}, process {pid}", help=_STOP_IT)


def request_handover(
    master: str, digest: str
) -> tuple[HandoverAnswer, int, socket.socket, int] | None:
    """Offer to supervise the guard on a master; None if there is none of this user.

    Returns its answer, its process, the connection and the shared memory (-1 if it gives none).
    """
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    sock.settimeout(_TIMEOUT_S)
    try:
        sock.connect(guard_address(master))
    except OSError:
        sock.close()
        return None
    if not _is_visible_and_ours(sock):
        sock.close()
        return None
    pid, _ = peer_credentials(sock)
    answer, memory = _send_offer(sock, digest)
    return answer, pid, sock, memory


def _is_visible_and_ours(sock: socket.socket) -> bool:
    """Tell whether the other end is of our user, and in a PID namespace that we see.

    The kernel gives 0 for a process that we do not see (pid_namespaces(7)), and a signal to 0
    would reach ourselves.
    """
    pid, uid = peer_credentials(sock)
    return pid > 0 and uid == os.getuid()


def _send_offer(sock: socket.socket, digest: str) -> tuple[HandoverAnswer, int]:
    try:
        sock.sendall(json.dumps({"config": digest}).encode() + b"\n")
        line, pages, _, _ = socket.recv_fds(sock, _MAX_LINE_BYTES, 1)
        answer = HandoverAnswer(json.loads(line)["answer"])
    except (OSError, ValueError, LookupError, TypeError):
        return HandoverAnswer.NONE, -1
    return answer, pages[0] if pages else -1


def _parse_digest(line: bytes) -> str:
    try:
        request = json.loads(line)
    except (ValueError, RecursionError):
        request = None
    return str(request.get("config")) if isinstance(request, dict) else ""


def _peer_at(master: str) -> tuple[int, int] | None:
    """Return the process and the user that listen there, ours if too many wait; None if nobody."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(0)
        try:
            sock.connect(guard_address(master))
        except BlockingIOError:
            return 0, os.getuid()
        except OSError:
            return None
        return peer_credentials(sock)
