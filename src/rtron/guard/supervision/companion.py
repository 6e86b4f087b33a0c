"""The link process beside the guard: started, started again when it ends, ended at the end."""

import logging
import signal
import subprocess

from rtron.guard.supervision.programs import LINK, command
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

_AGAIN = SECOND
_ENDING_S = 4.0


class Companion:
    """Keeps one process running; the robot's safety does not hang on it."""

    def __init__(self, order_file: int) -> None:
        self._order_file = order_file
        self._process: subprocess.Popen[bytes] | None = None
        self._due = 0

    def look(self, now: int) -> None:
        """Start the process if it does not run, once a second at most."""
        if now < self._due or (self._process and self._process.poll() is None):
            return
        self._due = now + _AGAIN
        words = command(LINK, [self._order_file])
        try:
            self._process = subprocess.Popen(words, pass_fds=[self._order_file])  # noqa: S603
        except OSError as error:
            log.warning("the link process cannot be started, tried again soon: %s", error)

    def dismiss(self) -> None:
        """End it; it has a moment to deliver what waits."""
        if self._process is None or self._process.poll() is not None:
            return
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.wait(_ENDING_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
