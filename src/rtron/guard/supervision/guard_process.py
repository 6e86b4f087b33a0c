"""The guard, seen from its supervisor: a process, the connection to it, and what they share."""

import signal
import socket
from contextlib import suppress

from rtron.guard.supervision.fork_server import ForkedProcess, ForkServer
from rtron.guard.supervision.programs import GUARD
from rtron.guard.supervision.shared_memory import BEGIN, GuardMemory

_LEAVE_S = 1.0


class GuardProcess:
    """A guard that was started."""

    def __init__(
        self, process: ForkedProcess, memory: GuardMemory, connection: socket.socket
    ) -> None:
        self.memory = memory
        self.connection = connection
        self._process = process
        connection.settimeout(0)

    @property
    def pid(self) -> int:
        """Its process id, 0 until it is started."""
        return self._process.pid

    def begin(self, handover_state: bytes, failure_report: bytes) -> None:
        """Let the guard begin, with what the one before has left, and what became of it."""
        self.memory.handover_state.write(handover_state)
        self.memory.failure_report.write(failure_report)
        with suppress(OSError):  # it has ended: the supervisor sees that as well
            self.connection.send(BEGIN)

    def discard(self) -> None:
        """Do without a guard that has not begun; it has a moment to leave the graph."""
        self.connection.close()
        self._process.wait(_LEAVE_S)
        self.send_signal(signal.SIGKILL)
        self._process.wait(_LEAVE_S)
        self.memory.close()

    def send_signal(self, number: int) -> None:
        """Send a signal; nothing if the guard has ended."""
        self._process.send_signal(number)

    def exit_code(self) -> int | None:
        """Return the exit code, minus the signal that killed it; None while it lives."""
        return self._process.poll()


def spawn_guard(
    server: ForkServer, config_file: int, bulk_port: socket.socket, streams: int
) -> GuardProcess:
    """Start a guard with a page of its own; it waits until it is told to begin.

    OSError if the system gives no memory, file or process for it.
    """
    memory = GuardMemory.create(streams)
    try:
        return _spawn(server, [config_file, bulk_port.fileno()], memory)
    except BaseException:
        memory.close()
        raise


def _spawn(server: ForkServer, files: list[int], memory: GuardMemory) -> GuardProcess:
    parent_socket, child_socket = socket.socketpair()
    try:
        process = server.start(GUARD, [*files, memory.descriptor, child_socket.fileno()])
    except BaseException:
        parent_socket.close()
        raise
    finally:
        child_socket.close()
    return GuardProcess(process, memory, parent_socket)
