"""One guard at a master: its supervisor holds one name there, its command process another.

A name is an address in no file system, which the kernel frees when its process ends, however it
ends. So a supervisor that starts finds the one that runs, or a guard that has lost its own.
"""

import os
import signal
import socket
import time
from contextlib import suppress

from rtron.errors import SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.supervision.supervisor_fsm import END_TIMEOUT
from rtron.guard.system.unix_socket import abstract_address, peer_credentials, user_name

SUPERVISOR, GUARD = "supervisor", "guard"
_PAUSE_S = 0.05
_RETRIES = 20


def take_name(role: str, master: str) -> socket.socket | None:
    """Return a socket that holds the name of a `role` at a master until it is closed.

    None if another user has the name, or what is no guard: it does not listen. SourceError if a
    process of the same user has that role.
    """
    holder: tuple[int, int] | None = None
    for _ in range(_RETRIES):
        if name := _bind(role, master):
            name.listen()
            return name
        holder = _holder(role, master)
        if holder and holder[1] != os.getuid():
            return None
        time.sleep(_PAUSE_S)  # it may be dying
    if holder is None:
        return None
    raise _guard_exists(master, holder[0])


def answer_name(loop: EventLoop, name: socket.socket) -> None:
    """Let who asks see which process holds a name."""

    def answer() -> None:
        name.accept()[0].close()

    loop.watch(name, answer, lambda error: loop.suspend(name, _PAUSE_S))


def await_former_guard(master: str, ramp: int) -> bool:
    """Wait until a guard that has lost its supervisor has ended; return whether there was one.

    It stops the robot first, if it can. One that takes `END_TIMEOUT` longer than its `ramp` (ns)
    is killed. SourceError if we do not see its process.
    """
    pid, uid = _holder(GUARD, master) or (0, -1)
    until = EventLoop.now() + ramp + END_TIMEOUT
    is_there = uid == os.getuid()
    while uid == os.getuid() and _is_held(GUARD, master):
        if EventLoop.now() > until and pid == 0:
            raise _guard_exists(master, pid)
        if EventLoop.now() > until:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        time.sleep(_PAUSE_S)
    return is_there


def _guard_exists(master: str, pid: int) -> SourceError:
    process = pid or "unknown, in another container or too busy to tell"
    return SourceError(f"a guard is running on {master}, process {process}", help="stop it first")


def _bind(role: str, master: str) -> socket.socket | None:
    """Return a socket with the name; None if another has it."""
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    sock.settimeout(0)
    try:
        sock.bind(_address(role, master))
    except OSError:
        sock.close()
        return None
    return sock


def _is_held(role: str, master: str) -> bool:
    name = _bind(role, master)
    if name:
        name.close()
    return name is None


def _address(role: str, master: str) -> bytes:
    return abstract_address(user_name(role, master.rstrip("/").encode()))


def _holder(role: str, master: str) -> tuple[int, int] | None:
    """Return the process and the user that listen there, ours if too many wait; None if nobody.

    The process is 0 where we do not see it (pid_namespaces(7)): a signal to 0 would reach us.
    """
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(0)
        try:
            sock.connect(_address(role, master))
        except BlockingIOError:
            return 0, os.getuid()
        except OSError:
            return None
        return peer_credentials(sock)
