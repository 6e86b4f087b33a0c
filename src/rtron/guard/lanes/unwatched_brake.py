"""The stop of a robot that nobody looks after: an intruder would not be found without an audit."""

import logging

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.bulk_connection import BulkConnection
from rtron.vocabulary import SECOND, Mode

log = logging.getLogger(__name__)

LONGEST_UNWATCHED = 10 * SECOND
"""How long the guard goes on without an audit, ns: a bulk process that ends is back in less."""
SHORTEST_AUDIT = 3 * SECOND
"""How long one must be connected to count, ns: one that ends again and again finds nobody."""
_CHECK_S = 1.0
_SOURCE = "no audit"
_REASON = "nobody looks for intruders: the bulk process has been away for 10 s"


class UnwatchedBrake:
    """Keeps the robot stopped from then on until the audit is connected again."""

    def __init__(self, connection: BulkConnection, host: Coordinator, loop: EventLoop) -> None:
        self._connection = connection
        self._loop = loop
        self._streams = [each for each in host.streams if each.spec.mode is Mode.ENFORCE]
        self._watched_at = loop.now()
        self._connected_at: int | None = None
        self._is_held = False

    def open(self) -> None:
        """Look from now on."""
        self._loop.call_later(_CHECK_S, self.open)
        now = self._loop.now()
        if not self._connection.is_connected:
            self._connected_at = None
        elif self._connected_at is None:
            self._connected_at = now
        elif now - self._connected_at >= SHORTEST_AUDIT:
            self._watched_at = now
        is_unwatched = now - self._watched_at > LONGEST_UNWATCHED
        if is_unwatched != self._is_held:
            self._is_held = is_unwatched
            self._hold() if is_unwatched else self._release()

    def close(self) -> None:
        """Look no more."""

    def _hold(self) -> None:
        for each in self._streams:
            each.brake(_SOURCE, _REASON)
        log.error("%s: the robot is stopped", _REASON)

    def _release(self) -> None:
        log.warning("the audit is connected again")
        for each in self._streams:
            each.release(_SOURCE)
