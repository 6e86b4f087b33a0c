"""The fork server: it has loaded what the guard's programs need, and starts each by a fork.

It is forked from the supervisor before that has a thread or a node. So a program begins at once,
and what is loaded is in memory once. Its processes are its children, and it tells the supervisor
how they end; the supervisor never waits for it. It ends with the supervisor.
"""

import json
import logging
import os
import select
import signal
import socket
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from itertools import count
from typing import NamedTuple, NoReturn

from rtron.errors import SourceError
from rtron.guard.supervision.programs import GUARD, TERMINAL_SIGNALS, process_name
from rtron.guard.supervision.watchdog import HangWatch
from rtron.guard.system.process_attributes import end_with_parent, set_process_name
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

START_FAILED, UNKNOWN_END = 256, 257
"""Instead of an exit code: of a process that was not started, and of one that nobody waited for."""


class ForkedProcess:
    """A process that a fork server starts; `pid` is 0 until it has."""

    def __init__(self) -> None:
        self.pid = 0
        self._code: int | None = None
        self._descriptor = -1
        self._signals: list[int] = []
        self._has_server = True

    def poll(self) -> int | None:
        """Return the exit code, minus the signal that killed it; None while it is not known.

        `START_FAILED` or `UNKNOWN_END` if there is none.
        """
        if not self._has_server and (self._descriptor < 0 or self.wait(0)):
            self.note_ended(UNKNOWN_END)
        return self._code

    def wait(self, timeout: float) -> bool:
        """Wait for the end of one that was started, s; return whether it has ended."""
        if self._code is None and self._descriptor >= 0:
            return bool(select.select([self._descriptor], (), (), timeout)[0])
        return self._code is not None

    def send_signal(self, number: int) -> None:
        """Send a signal, as soon as it is started; nothing if it has ended."""
        if self._descriptor >= 0:
            with suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._descriptor, number)
        elif self._code is None:
            self._signals.append(number)

    def note_started(self, pid: int, files: Sequence[int]) -> None:
        """Take its id and the file descriptor that stands for it; without one it is killed."""
        self.pid = pid
        if not files:  # this process has too many open files
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            return
        (self._descriptor,) = files
        for number in self._signals:
            self.send_signal(number)

    def note_ended(self, code: int) -> None:
        """Take how it has ended."""
        if self._code is None:
            self._code = code
            if self._descriptor >= 0:
                os.close(self._descriptor)
            self._descriptor = -1

    def note_server_lost(self) -> None:
        """Take note that nobody will tell how it has ended."""
        self._has_server = False


_MOST_FILES = 8
_MOST_BYTES = 1 << 10
_BEAT_S = SharedBeat.PERIOD / SECOND
_END_S = 10.0
"""How long the processes may take to end after the supervisor; `HelperProcess` waits as long."""
_STARTED, _ENDED, _FAILED = "started", "ended", "failed"
_BLOCKED = frozenset({*TERMINAL_SIGNALS, signal.SIGTERM})
"""A process that is started has these while it cannot handle them yet: none is lost."""


class ForkServer:
    """The supervisor's side; `connection` can be read when there is something to `receive`."""

    def __init__(self) -> None:
        """Fork this process, whose threads are not in the fork.

        SourceError if the system has no file descriptors of processes.
        """
        _check_system()
        self.connection, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._beat = SharedBeat.create()
        self._pid = os.fork()
        if self._pid == 0:
            self.connection.close()
            _Server(other, self._beat).run()
        other.close()
        self.connection.settimeout(0)
        self._hang_watch = HangWatch(time.monotonic_ns(), SharedBeat.PERIOD)
        self._numbers = count()
        self._processes: dict[int, ForkedProcess] = {}

    def start(self, entry_point: str, files: Sequence[int]) -> ForkedProcess:
        """Have a program (`module:function`) started that has the open `files`.

        It hears no terminal before `leave_terminal`. OSError if the request cannot be sent.
        """
        number = next(self._numbers)
        request = json.dumps([number, entry_point]).encode()
        socket.send_fds(self.connection, [request], files)
        process = self._processes[number] = ForkedProcess()
        return process

    def receive(self) -> bool:
        """Take what the fork server tells of one process, if it does; False once it is gone."""
        try:
            message, files, _, _ = socket.recv_fds(self.connection, _MOST_BYTES, 1)
        except BlockingIOError:
            return True
        except OSError:
            message, files = b"", []
        if message:
            self._take(message, files)
        else:
            for process in self._processes.values():
                process.note_server_lost()
        return bool(message)

    def end_if_hung(self, now: int) -> None:
        """Kill the fork server if it stands still at `now` (ns): it is gone then."""
        if self._hang_watch.is_hung(now, self._beat.at):
            os.kill(self._pid, signal.SIGKILL)

    def _take(self, message: bytes, files: list[int]) -> None:
        number, what, value = json.loads(message)
        if what == _STARTED:
            self._processes[number].note_started(value, files)
            return
        if what == _FAILED:
            log.warning("a process of the guard cannot be started: %s", os.strerror(value))
        process = self._processes.pop(number)
        process.note_ended(START_FAILED if what == _FAILED else value)


def _check_system() -> None:
    try:
        os.close(os.pidfd_open(os.getpid()))
    except (AttributeError, OSError) as error:
        help = "it takes Linux 5.3, a Python with os.pidfd_open, and a container that permits it"
        raise SourceError(f"the guard's processes cannot be watched: {error}", help=help) from None


class _Child(NamedTuple):
    number: int
    pid: int
    entry_point: str


class _Server:
    """The fork server's side; a process that is started leaves it, and runs its program."""

    def __init__(self, connection: socket.socket, beat: SharedBeat) -> None:
        self._connection = connection
        self._beat = beat
        self._children: dict[int, _Child] = {}

    def run(self) -> NoReturn:
        """Do what the supervisor asks until it is gone; who ends all of us ends it, too."""
        signal.pthread_sigmask(signal.SIG_BLOCK, _BLOCKED)
        set_process_name("rtron-forks")
        while True:
            watched = [self._connection.fileno(), *self._children]
            ready = select.select(watched, (), (), _BEAT_S)[0]
            self._beat.at = time.monotonic_ns()
            for descriptor in ready:
                if descriptor in self._children:
                    self._reap(descriptor)
                else:
                    self._serve()

    def _serve(self) -> None:
        try:
            request, files, _, _ = socket.recv_fds(self._connection, _MOST_BYTES, _MOST_FILES)
        except ConnectionResetError:  # it has not read all that it was told
            request, files = b"", []
        if not request:
            self._end()
        number, entry_point = json.loads(request)
        self._start(number, entry_point, files)
        for each in files:
            os.close(each)

    def _start(self, number: int, entry_point: str, files: list[int]) -> None:
        pid, server = -1, os.getpid()
        try:
            pid = os.fork()
            descriptor = os.pidfd_open(pid) if pid else -1
        except OSError as failure:
            if pid > 0:
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
            self._tell(number, _FAILED, failure.errno or 0)
            return
        if pid == 0:
            self._leave()
            _run(entry_point, files, server)
        self._children[descriptor] = _Child(number, pid, entry_point)
        self._tell(number, _STARTED, pid, [descriptor])

    def _leave(self) -> None:
        """Close what is the fork server's own."""
        self._connection.close()
        for descriptor in self._children:
            os.close(descriptor)

    def _reap(self, descriptor: int) -> None:
        child = self._children.pop(descriptor)
        _, status = os.waitpid(child.pid, 0)
        os.close(descriptor)
        self._tell(child.number, _ENDED, os.waitstatus_to_exitcode(status))

    def _tell(self, number: int, what: str, value: int, files: Sequence[int] = ()) -> None:
        with suppress(OSError):  # the supervisor is gone
            message = json.dumps([number, what, value]).encode()
            socket.send_fds(self._connection, [message], files)

    def _end(self) -> NoReturn:
        """End the other processes in order; those that are left end with this one."""
        left = [each for each, child in self._children.items() if child.entry_point != GUARD]
        for descriptor in left:
            with suppress(ProcessLookupError):
                signal.pidfd_send_signal(descriptor, signal.SIGTERM)
        until = time.monotonic() + _END_S
        while left and time.monotonic() < until:
            ended = select.select(left, (), (), max(0.0, until - time.monotonic()))[0]
            left = [each for each in left if each not in ended]
        os._exit(0)


def _run(entry_point: str, files: list[int], server: int) -> NoReturn:
    end_with_parent(server)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    module, _, function = entry_point.partition(":")
    set_process_name(process_name(entry_point))
    main = getattr(import_module(f"rtron.guard.supervision.{module}"), function)
    main(",".join(map(str, files)))
    sys.exit()
