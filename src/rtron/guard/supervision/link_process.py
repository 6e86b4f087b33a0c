"""The link process beside the guard: started, started again when it ends, ended at the end."""

import logging
import signal
import subprocess

from rtron.guard.supervision.programs import LINK, command
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

SOONEST = SECOND
"""The shortest time between two starts, ns; it doubles while each ends soon."""
LATEST = 30 * SECOND
_ENDING_S = 4.0


class Companion:
    """Keeps one process running; the robot's safety does not hang on it.

    One that ends at once, for instance since another supervisor's still runs, is tried more seldom.
    """

    def __init__(self, order_file: int, program: str = LINK) -> None:
        self.process: subprocess.Popen[bytes] | None = None
        self._words = command(program, [order_file])
        self._order_file = order_file
        self._started = 0
        self._due: int | None = 0
        self._pause = SOONEST

    def look(self, now: int) -> None:
        """Start the process at `now` (ns) if it does not run and it is time."""
        if self.process and self.process.poll() is None:
            return
        if self._due is None:
            self._due = now + self._wait(now - self._started)
        if now >= self._due:
            self._start(now)

    def _wait(self, life: int) -> int:
        """Return how long to wait after one that has lived for `life`."""
        wait = self._pause
        self._pause = SOONEST if life >= LATEST else min(2 * self._pause, LATEST)
        return SOONEST if life >= LATEST else wait

    def _start(self, now: int) -> None:
        self._started, self._due = now, None
        try:
            self.process = subprocess.Popen(self._words, pass_fds=[self._order_file])  # noqa: S603
        except OSError as error:
            self.process = None
            log.warning("the link process cannot be started, tried again soon: %s", error)

    def dismiss(self) -> None:
        """End it; it has a moment to deliver what waits."""
        if self.process is None or self.process.poll() is not None:
            return
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(_ENDING_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
