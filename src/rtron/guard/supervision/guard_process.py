"""The guard, seen from its supervisor: a process, the connection to it, and what they share."""

import os
import signal
import socket
import subprocess
import time
from contextlib import suppress

from rtron.errors import SourceError
from rtron.guard.core.event_loop import Loop
from rtron.guard.supervision.guard_config import Order
from rtron.guard.supervision.guard_socket import is_running
from rtron.guard.supervision.programs import GUARD, command
from rtron.guard.supervision.shared_memory import Field, Page
from rtron.guard.supervision.supervisor_fsm import OK
from rtron.guard.supervision.supervisor_handover import BEGIN, Answer, offer
from rtron.vocabulary import SECOND

_ENDING = 8 * SECOND
_PAUSE_S = 0.02


class Ward:
    """A guard that was started, or one that was found running and taken over."""

    def __init__(
        self, pid: int, page: Page, life: socket.socket, process: subprocess.Popen[bytes] | None
    ) -> None:
        self.pid = pid
        self.page = page
        self.life = life
        self._process = process
        self._killed = False
        life.settimeout(0)

    def begin(self, will: bytes, news: bytes) -> None:
        """Let the guard begin, with what the one before has left, and what became of it."""
        self.page.will.write(will)
        self.page.news.write(news)
        with suppress(OSError):
            self.life.send(BEGIN)

    def dismiss(self) -> None:
        """Do without a guard that has not begun."""
        self.tell(signal.SIGKILL)
        if self._process:
            self._process.wait()
        self.life.close()
        self.page.close()

    def tell(self, number: int) -> None:
        """Send a signal; nothing if the guard has ended."""
        self._killed = self._killed or number == signal.SIGKILL
        with suppress(ProcessLookupError):
            if self._process:
                self._process.send_signal(number)
            else:
                os.kill(self.pid, number)

    def code(self) -> int | None:
        """Return the exit code, minus the signal that killed it; None while it lives.

        Only a parent is told: another guard has ended in order if it said so.
        """
        if self._process:
            return self._process.poll()
        if is_running(self.pid) and not self._killed:
            return None
        return OK if self.page[Field.LEAVING] else -signal.SIGKILL


def spawn(order_file: int, streams: int) -> Ward:
    """Start a guard with a page of its own; it waits until it is told to begin.

    OSError if the system gives no memory, file or process for it.
    """
    page = Page.new(streams)
    try:
        return _spawn(order_file, page)
    except BaseException:
        page.close()
        raise


def _spawn(order_file: int, page: Page) -> Ward:
    ours, its = socket.socketpair()
    # What a terminal says to all of us is the supervisor's to hear, also while the guard starts.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    files = (order_file, page.descriptor, its.fileno())
    try:
        process = subprocess.Popen(command(GUARD, files), pass_fds=files)  # noqa: S603
    except BaseException:
        ours.close()
        raise
    finally:
        its.close()
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    return Ward(process.pid, page, ours, process)


def adopt(order: Order, streams: int) -> Ward | None:
    """Take over the guard that runs on the master; None if there is none, or none any more.

    One that does not answer, or guards by another plan, is ended. SourceError if it has a
    supervisor.
    """
    found = offer(order.master, order.digest)
    if found is None:
        return None
    answer, pid, life, page = found
    if answer is Answer.YES:
        return Ward(pid, Page(page, streams), life, None)
    if answer is Answer.SUPERVISED:
        told = f"a guard is running on {order.master}, process {pid}"
        raise SourceError(told, help="stop it first")
    with life:
        _end(pid, in_order=answer is Answer.OTHER)
    return None


def _end(pid: int, *, in_order: bool) -> None:
    """End a guard that is not ours to keep."""
    until = Loop.now() + _ENDING
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGTERM if in_order else signal.SIGKILL)
        while in_order and is_running(pid) and Loop.now() < until:
            time.sleep(_PAUSE_S)
        os.kill(pid, signal.SIGKILL)
