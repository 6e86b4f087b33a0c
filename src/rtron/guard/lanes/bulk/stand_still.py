"""The end of a bulk process that stood still: it may hear nothing any more.

Where a reader does not run for a second, Fast DDS gives up the shared memory in which it reads
(`SharedMemTransportDescriptor`, port queue and healthy check), and not every writer finds the next.
"""

import logging
import time
from contextlib import suppress
from pathlib import Path

from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

LONGEST_STAND = 4 * SECOND // 5
"""What a process may stand still at once, ns: less than what Fast DDS waits for."""
_PERIOD = SECOND // 10
_SCHEDSTAT = Path("/proc/thread-self/schedstat")


class StandStillClock:
    """How long a process stood still between two looks, while the system let it run; sans-I/O.

    One that has to wait for a processor, or works, does not stand still.
    """

    def __init__(self, now: int, busy: int) -> None:
        self._looked_at, self._busy = now, busy

    def update(self, now: int, busy: int) -> int:
        """Return for how much of the time since the last look it did nothing, ns.

        `busy` is how long it has run or waited for a processor since its start, ns.
        """
        idle = (now - self._looked_at) - (busy - self._busy)
        self._looked_at, self._busy = now, busy
        return max(0, idle)


class StandStillEnd:
    """Ends the process after it stood still, for example by SIGSTOP or a frozen cgroup."""

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop

    def open(self) -> None:
        """Look from now on, in the thread that runs the loop."""
        self._clock = StandStillClock(self._loop.now(), _busy_time())
        self._look_again()

    def close(self) -> None:
        """Look no more."""

    def _look_again(self) -> None:
        self._loop.call_at(self._loop.now() + _PERIOD, self._look)

    def _look(self) -> None:
        stand = self._clock.update(self._loop.now(), _busy_time())
        if stand < LONGEST_STAND:
            self._look_again()
        else:
            log.error("the bulk process stood still for %.1f s, and may be deaf", stand / SECOND)
            log.error("it ends, and the next one begins")
            self._loop.stop()


def _busy_time() -> int:
    """Return how long this thread has run or waited for a processor, ns."""
    with suppress(OSError):  # a kernel without schedstats tells only how long it has run
        ran, waited, _ = map(int, _SCHEDSTAT.read_text().split())
        return ran + waited
    return time.thread_time_ns()
