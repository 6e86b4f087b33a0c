"""A process that the fork server starts, as the supervisor sees it: it never waits to know more."""

import os
import select
import signal
from collections.abc import Sequence
from contextlib import suppress

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
