"""An eventfd that the loop watches: others count up, the loop is called with the count."""

from __future__ import annotations

import logging
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import Loop

log = logging.getLogger(__name__)

_MOST = 64


class Bell:
    """Calls `take(count)`, at most 64 at a time, so that no flood keeps the loop from others."""

    def __init__(self, loop: Loop, take: Callable[[int], None]) -> None:
        self._loop = loop
        self._take = take
        self.fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        loop.watch(self, self._rung, self._failed)

    def fileno(self) -> int:
        """Return the descriptor, as a selector asks for it."""
        return self.fd

    def close(self) -> None:
        """Close the descriptor; the loop calls it."""
        if self.fd >= 0:
            os.close(self.fd)
        self.fd = -1

    def silence(self) -> None:
        """Be called no more."""
        self._loop.forget(self)

    def _rung(self) -> None:
        """Have what is there taken; after a failure once more as often, so that nothing stays."""
        count = os.eventfd_read(self.fd)
        if count > _MOST:
            os.eventfd_write(self.fd, count - _MOST)
        try:
            self._take(min(count, _MOST))
        except Exception:
            if count > 1 and self.fd >= 0:
                os.eventfd_write(self.fd, min(count, _MOST) - 1)
            raise

    def _failed(self, error: Exception) -> None:
        log.error("news of ROS 2 could not be dealt with: %s", error)
