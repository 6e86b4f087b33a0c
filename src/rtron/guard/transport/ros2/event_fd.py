"""An eventfd that the event loop watches: DDS adds to it, the loop calls back with the count."""

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
    """Calls `on_count(count)`, at most 64 at a time, so that a flood does not block the loop.

    It may return how many it left for later, behind other events of the loop.
    """

    def __init__(self, loop: EventLoop, on_count: Callable[[int], int | None]) -> None:
        self._loop = loop
        self._on_count = on_count
        self.fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        loop.watch(self, self._on_readable, self._on_error)

    def fileno(self) -> int:
        """Return the descriptor, for a selector."""
        return self.fd

    def close(self) -> None:
        """Close the descriptor; only the loop calls it."""
        if self.fd >= 0:
            os.close(self.fd)
        self.fd = -1

    def stop(self) -> None:
        """Stop watching, and close."""
        self._loop.forget(self)

    def _on_readable(self) -> None:
        """Pass on the count; after a failure count the rest again, so that no message stays."""
        count = os.eventfd_read(self.fd)
        now = min(count, _MAX_COUNT)
        left = now - 1
        try:
            left = self._on_count(now) or 0
        finally:
            left += count - now
            if left and self.fd >= 0:
                os.eventfd_write(self.fd, left)

    def _on_error(self, error: Exception) -> None:
        log.error("an event of ROS 2 could not be handled: %s", error)
