"""The guard, seen from its supervisor: a process, the connection to it, and what they share."""

import os
import signal
import socket
import subprocess
import time
from contextlib import suppress

from rtron.errors import SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.programs import GUARD, start_program
from rtron.guard.supervision.shared_memory import GuardMemory, StatusWord
from rtron.guard.supervision.supervisor_fsm import END_TIMEOUT, OK
from rtron.guard.supervision.supervisor_handover import (
    BEGIN,
    WATCHING_MESSAGE,
    HandoverAnswer,
    is_running,
    request_handover,
)

_PAUSE_S = 0.02
_LEAVE_S = 1.0


class GuardProcess:
    """A guard that was started, or one that was found running and taken over."""

    def __init__(
        self,
        pid: int,
        memory: GuardMemory,
        connection: socket.socket,
        process: subprocess.Popen[bytes] | None,
    ) -> None:
        self.pid = pid
        self.memory = memory
        self.connection = connection
        self._process = process
        self._is_killed = False
        connection.settimeout(0)

    def begin(self, handover_state: bytes, failure_report: bytes) -> None:
        """Let the guard begin, with what the one before has left, and what became of it."""
        self.memory.handover_state.write(handover_state)
        self.memory.failure_report.write(failure_report)
        with suppress(OSError):  # it has ended: the supervisor sees that as well
            self.connection.send(BEGIN)

    def notify_watching(self) -> None:
        """Let a guard that was taken over know that it is watched from now on."""
        with suppress(OSError):  # it has ended: the supervisor sees that as well
            self.connection.send(WATCHING_MESSAGE)

    def discard(self) -> None:
        """Do without a guard that has not begun; it has a moment to leave the graph."""
        self.connection.close()
        if self._process:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(_LEAVE_S)
            self.send_signal(signal.SIGKILL)
            self._process.wait()
        self.memory.close()

    def send_signal(self, number: int) -> None:
        """Send a signal; nothing if the guard has ended."""
        self._is_killed = self._is_killed or number == signal.SIGKILL
        with suppress(ProcessLookupError):
            if self._process:
                self._process.send_signal(number)
            else:
                os.kill(self.pid, number)

    def exit_code(self) -> int | None:
        """Return the exit code, minus the signal that killed it; None while it lives.

        Only a parent is told: another guard has ended in order if it said so.
        """
        if self._process:
            return self._process.poll()
        if is_running(self.pid) and not self._is_killed:
            return None
        return OK if self.memory[StatusWord.LEAVING] else -signal.SIGKILL


def spawn_guard(config_file: int, streams: int) -> GuardProcess:
    """Start a guard with a page of its own; it waits until it is told to begin.

    OSError if the system gives no memory, file or process for it.
    """
    memory = GuardMemory.create(streams)
    try:
        return _spawn(config_file, memory)
    except BaseException:
        memory.close()
        raise


def _spawn(config_file: int, memory: GuardMemory) -> GuardProcess:
    parent_socket, child_socket = socket.socketpair()
    try:
        process = start_program(GUARD, (config_file, memory.descriptor, child_socket.fileno()))
    except BaseException:
        parent_socket.close()
        raise
    finally:
        child_socket.close()
    return GuardProcess(process.pid, memory, parent_socket, process)


def adopt_guard(config: GuardConfig, streams: int) -> GuardProcess | None:
    """Take over the guard that runs on the master; None if there is none, or none any more.

    One that does not answer, or guards by another plan, is ended. SourceError if it has a
    supervisor.
    """
    found = request_handover(config.master, config.digest)
    if found is None:
        return None
    answer, pid, connection, memory = found
    if answer is HandoverAnswer.YES:
        return GuardProcess(pid, GuardMemory(memory, streams), connection, None)
    if answer is HandoverAnswer.SUPERVISED:
        message = f"a guard is running on {config.master}, process {pid}"
        raise SourceError(message, help="stop it first")
    with connection:
        _end(pid, in_order=answer is HandoverAnswer.OTHER)
    return None


def _end(pid: int, *, in_order: bool) -> None:
    """End a guard that is not ours to keep."""
    until = EventLoop.now() + END_TIMEOUT
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGTERM if in_order else signal.SIGKILL)
        while in_order and is_running(pid) and EventLoop.now() < until:
            time.sleep(_PAUSE_S)
        os.kill(pid, signal.SIGKILL)
