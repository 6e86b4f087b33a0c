"""Which messages came late, and which did not come at all.

A guard that was stalled does not forward old commands. DDS gives the time that a message was sent
by its publisher's wall clock, which may differ from ours. So each message's delay between these two
clocks is compared with the publisher's typical one. The time of reception does not help: while the
whole process is stopped, nothing is received.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

_LATE = SECOND // 4
"""Half of the usual time after which a flow counts as silent."""
_CLOCK_CHANGE_TIMEOUT = SECOND
_SMOOTHING_SHIFT = 8
_MOST = 256
_MAX_NUMBERED = 4096


@dataclass(slots=True)
class _TypicalDelay:
    """The typical delay of a publisher's messages (ns, by two clocks); since when they are late."""

    delay: int
    late_since: int | None = None


class LatenessDetector:
    """Tells whether a message took 250 ms longer than its publisher's typical delay.

    A clock that was set makes all messages late, but only for a second: then the new delay is the
    typical one.
    """

    def __init__(self) -> None:
        self._typical_delays: dict[bytes, _TypicalDelay] = {}

    def is_late(
        self, publisher: bytes, source_time: int, now: int, steady_clock: Callable[[], int]
    ) -> bool:
        """Return whether a message that is taken `now` is late.

        `now` and `source_time` are ns of wall clocks, `source_time` is 0 if unknown; `steady_clock`
        is one that nobody sets.
        """
        if not source_time:
            return False
        typical = self._typical_delays.get(publisher)
        if typical is None:
            self._add_publisher(publisher, now - source_time)
            return False
        excess = now - source_time - typical.delay
        if excess > _LATE:
            return self._is_still_late(typical, now - source_time, steady_clock())
        typical.delay += excess if excess < 0 else excess >> _SMOOTHING_SHIFT
        typical.late_since = None
        return False

    def _add_publisher(self, publisher: bytes, delay: int) -> None:
        if len(self._typical_delays) == _MOST:
            self._typical_delays.clear()
        self._typical_delays[publisher] = _TypicalDelay(delay)

    def _is_still_late(self, typical: _TypicalDelay, delay: int, steady: int) -> bool:
        if typical.late_since is None:
            typical.late_since = steady
        if steady - typical.late_since < _CLOCK_CHANGE_TIMEOUT:
            return True
        typical.delay, typical.late_since = delay, None
        return False


class SequenceGaps:
    """Tells how many messages of a publisher, by its GID, are missing before one that arrived.

    DDS numbers them.
    What was sent before the first message that was seen may have been sent before anybody listened.
    It is missing only as far as messages were replaced in the queue, unread: `replaced` tells that.
    """

    def __init__(self) -> None:
        self._expected: dict[bytes, int] = {}
        self._newest: bytes | None = None
        self._explained = 0

    def see(self, gid: bytes, number: int | None) -> None:
        """Note a message that waits: if it is never passed on, it counts as missing."""
        if number is not None and len(self._expected) < _MAX_NUMBERED:
            self._expect_from(gid, number)

    def missing_before(self, gid: bytes, number: int | None) -> int:
        """Return how many are missing before a message that is passed on, and expect the next."""
        if number is None:
            return 0
        expected = self._expect_from(gid, number)
        self._expected[gid] = max(expected, number + 1)
        missing = max(0, number - expected)
        self._explained += missing
        return missing

    def is_repeated(self, gid: bytes, number: int | None) -> bool:
        """Return whether a message comes behind newer ones: it was passed on before."""
        return number is not None and number < self._expected.get(gid, 0)

    def replaced(self, count: int) -> tuple[bytes | None, int]:
        """Return the newest publisher, and how many of its first messages were replaced.

        `count` is how many of all publishers were replaced, of which the gaps explain some.
        """
        explained = min(count, self._explained)
        self._explained -= explained
        return self._newest, count - explained

    def forget(self, gid: bytes) -> None:
        """Forget a publisher that has left."""
        self._expected.pop(gid, None)

    def _expect_from(self, gid: bytes, number: int) -> int:
        if gid not in self._expected:
            self._expected[gid] = number
            self._newest, self._explained = gid, 0
        return self._expected[gid]
