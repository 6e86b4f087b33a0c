"""Work that may hang, as all work on files may: a disk or a network file system does not answer."""

import logging
from collections.abc import Callable
from threading import Event, Thread

log = logging.getLogger(__name__)


class BackgroundWorker:
    """A thread that works whenever it is asked; who asks never waits.

    Asked while it works, it works once more. It keeps no process from ending.
    """

    def __init__(self, work: Callable[[], None], name: str) -> None:
        self._work = work
        self._is_asked = Event()
        Thread(target=self._run, name=name, daemon=True).start()

    def request(self) -> None:
        """Ask for the work, now or as soon as the thread is free."""
        self._is_asked.set()

    def _run(self) -> None:
        while True:
            self._is_asked.wait()
            self._is_asked.clear()
            try:
                self._work()
            except Exception:
                log.exception("internal error in a thread of the guard; it goes on")
