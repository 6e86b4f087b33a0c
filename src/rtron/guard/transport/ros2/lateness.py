"""Whose messages come late: a guard that was stalled does not do what was meant for the moment.

DDS tells when a message was said by its publisher's wall clock, which need not be ours. So each
publisher's messages are compared with how long they take as a rule, by these two clocks. When they
were received does not matter: while the whole process is stopped, nothing is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

_LATE = SECOND // 4
"""Half of the time after which a flow is silent, as a rule."""
_CLOCK_WAS_SET = SECOND
_SLOWLY = 8
_MOST = 256


@dataclass(slots=True)
class _Usual:
    """How long a publisher's messages take (ns, by two clocks); since when they come late."""

    took: int
    late_since: int | None = None


class Lateness:
    """Tells whether a message took 250 ms longer than its publisher's do.

    A clock that was set makes all late, but for a second only: then that is how it is.
    """

    def __init__(self) -> None:
        self._usual: dict[bytes, _Usual] = {}

    def is_late(self, publisher: bytes, said: int, now: int, steady: Callable[[], int]) -> bool:
        """Tell it of a message that is taken `now`; `said` is 0 if nobody knows (wall clocks, ns).

        `steady` tells the time by a clock that nobody sets.
        """
        if not said:
            return False
        usual = self._usual.get(publisher)
        if usual is None:
            self._meet(publisher, now - said)
            return False
        over = now - said - usual.took
        if over > _LATE:
            return self._is_late_still(usual, now - said, steady())
        usual.took += over if over < 0 else over >> _SLOWLY
        usual.late_since = None
        return False

    def _meet(self, publisher: bytes, took: int) -> None:
        if len(self._usual) == _MOST:
            self._usual.clear()
        self._usual[publisher] = _Usual(took)

    def _is_late_still(self, usual: _Usual, took: int, steady: int) -> bool:
        if usual.late_since is None:
            usual.late_since = steady
        if steady - usual.late_since < _CLOCK_WAS_SET:
            return True
        usual.took, usual.late_since = took, None
        return False
