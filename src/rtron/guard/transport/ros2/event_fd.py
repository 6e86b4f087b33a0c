"""An eventfd that the loop watches: others count up, the loop is called with the count."""

from __future__ import annotations

import logging
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)

_MAX_COUNT = 64


class EventFd:
    """Calls `take(count)`, at most 64 at a time, so that no flood keeps the loop from others."""

    def __init__(self, loop: EventLoop, on_count: Callable[[int], None]) -> None:
        self._loop = loop
        self._on_count = on_count
        self.fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        loop.watch(self, self._on_readable, self._on_error)

    def fileno(self) -> int:
        """Return the descriptor, as a selector asks for it."""
        return self.fd

    def close(self) -> None:
        """Close the descriptor; the loop calls it."""
        if self.fd >= 0:
            os.close(self.fd)
        self.fd = -1

    def stop(self) -> None:
        """Be called no more."""
        self._loop.forget(self)

    def _on_readable(self) -> None:
        """Have what is there taken; after a failure once more as often, so that nothing stays."""
        count = os.eventfd_read(self.fd)
        if count > _MAX_COUNT:
            os.eventfd_write(self.fd, count - _MAX_COUNT)
        try:
            self._on_count(min(count, _MAX_COUNT))
        except Exception:
            if count > 1 and self.fd >= 0:
                os.eventfd_write(self.fd, min(count, _MAX_COUNT) - 1)
            raise

    def _on_error(self, error: Exception) -> None:
        log.error("news of ROS 2 could not be dealt with: %s", error)
