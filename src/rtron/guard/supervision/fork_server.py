"""The fork server: it has loaded what the guard's programs need, and starts each by a fork.

It is forked from the supervisor before that has a thread or a node. So a program begins at once,
and what is loaded is in memory once. Its processes are its children: it waits for their end when
the supervisor asks, and ends with the supervisor.
"""

import json
import os
import select
import signal
import socket
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from rtron.errors import SourceError
from rtron.guard.supervision.programs import GUARD
from rtron.guard.system.parent_end import end_with_parent

_MOST_FILES = 8
_MOST_BYTES = 1 << 10
_ANSWER_S = 1.5
"""An answer takes a millisecond; a guard kills a supervisor that stands still for 2 s."""
_LOST = os.EX_OSERR
"""The exit code of a process whose end nobody can tell any more."""


class ForkServer:
    """The supervisor's side; `connection` can be read once the fork server is gone."""

    def __init__(self) -> None:
        """Fork this process, whose threads are not in the fork.

        SourceError if the system has no file descriptors of processes.
        """
        _check_system()
        self.connection, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._pid = os.fork()
        if self._pid == 0:
            self.connection.close()
            _serve(other)
        other.close()
        self.connection.settimeout(_ANSWER_S)

    def start(self, entry_point: str, files: Sequence[int]) -> "ForkedProcess":
        """Start a program (`module:function`) that has the open `files`.

        It does not hear Ctrl-C before `leave_interrupts`. OSError if the system cannot start it.
        """
        pid = self._ask(["start", entry_point], files)
        try:
            return ForkedProcess(self, pid)
        except OSError:
            os.kill(pid, signal.SIGKILL)
            self.exit_code(pid)
            raise

    def exit_code(self, pid: int) -> int:
        """Return how a process has ended that has, minus the signal if one has killed it."""
        try:
            return self._ask(["reap", pid])
        except OSError:
            return _LOST

    def _ask(self, question: list[object], files: Sequence[int] = ()) -> int:
        try:
            socket.send_fds(self.connection, [json.dumps(question).encode()], files)
            answer = self.connection.recv(_MOST_BYTES)
        except TimeoutError:  # its answer would be taken for that to the next question
            os.kill(self._pid, signal.SIGKILL)
            raise
        if not answer:
            raise ConnectionResetError("what starts the guard's processes is gone")
        number, error = json.loads(answer)
        if error:
            raise OSError(error, os.strerror(error))
        return int(number)


class ForkedProcess:
    """A process that a fork server has started; `pid` is its own until its end has been asked."""

    def __init__(self, server: ForkServer, pid: int) -> None:
        self.pid = pid
        self._server = server
        self._code: int | None = None
        self._descriptor = os.pidfd_open(pid)

    def poll(self) -> int | None:
        """Return the exit code, minus the signal that killed it; None while it lives."""
        self.wait(0)
        return self._code

    def wait(self, timeout: float) -> bool:
        """Wait for its end, s; return whether it has ended."""
        if self._code is None and select.select([self._descriptor], (), (), timeout)[0]:
            self._code = self._server.exit_code(self.pid)
            os.close(self._descriptor)
        return self._code is not None

    def send_signal(self, number: int) -> None:
        """Send a signal; nothing if it has ended."""
        if self._code is None:
            with suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._descriptor, number)


def _check_system() -> None:
    try:
        os.close(os.pidfd_open(os.getpid()))
    except (AttributeError, OSError) as error:
        help = "it takes Linux 5.3, a Python with os.pidfd_open, and a container that permits it"
        raise SourceError(f"the guard's processes cannot be watched: {error}", help=help) from None


def _serve(connection: socket.socket) -> NoReturn:
    """Do what the supervisor asks until it is gone; a process that is started runs its program."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # who ends all of us ends the supervisor, too
    set_process_name("rtron-forks")
    while True:
        question, files, _, _ = socket.recv_fds(connection, _MOST_BYTES, _MOST_FILES)
        if not question:
            os._exit(0)
        kind, subject = json.loads(question)
        answer = _fork(connection, subject, files) if kind == "start" else _reap(subject)
        with suppress(OSError):  # the supervisor is gone
            connection.send(json.dumps(answer).encode())


def _fork(connection: socket.socket, entry_point: str, files: list[int]) -> tuple[int, int]:
    """Return the process that runs a program, and the error if there is none."""
    pid, error, server = 0, 0, os.getpid()
    try:
        pid = os.fork()
    except OSError as failure:
        error = failure.errno or _LOST
    if pid == 0 and not error:
        connection.close()
        _run(entry_point, files, server)
    for each in files:
        os.close(each)
    return pid, error


def _run(entry_point: str, files: list[int], server: int) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if entry_point != GUARD:  # it stops the robot first
        end_with_parent(server, signal.SIGTERM)
    module, _, function = entry_point.partition(":")
    set_process_name(f"rtron-{module.removesuffix('_program')}")
    main = getattr(import_module(f"rtron.guard.supervision.{module}"), function)
    main(",".join(map(str, files)))
    sys.exit()


def _reap(pid: int) -> tuple[int, int]:
    """Return how a child has ended, and the error if it is none."""
    try:
        _, status = os.waitpid(pid, 0)
    except ChildProcessError as error:
        return 0, error.errno or _LOST
    return os.waitstatus_to_exitcode(status), 0


def set_process_name(name: str) -> None:
    """Let `ps -o comm` and `top` tell the processes apart: 15 characters (proc(5))."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name)
