"""Alarms that follow from a state looked at again and again: confirmed, then raised, then settled.

What nodes do while they come and go looks wrong for a moment; only what lasts is told.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from rtron.guard.audit.common.audit_response import AuditResponse
from rtron.vocabulary import Alarm


class DebouncedAlarms:
    """The alarms of one kind of look; each must last for `delay` (ns) before it is raised."""

    def __init__(self, response: AuditResponse, delay: int) -> None:
        self._response = response
        self._delay = delay
        self._since: dict[Alarm, int] = {}
        self._raised: set[Alarm] = set()

    @property
    def has_pending(self) -> bool:
        """Whether something is wrong for too short a time to be raised."""
        return bool(self._since.keys() - self._raised)

    def update(self, alarms: Iterable[Alarm], now: int) -> None:
        """Take all that is wrong at `now`; what was wrong before and is not here is settled."""
        active = dict.fromkeys(alarms)
        for alarm in [each for each in self._since if each not in active]:
            del self._since[alarm]
            if alarm in self._raised:
                self._raised.discard(alarm)
                self._response.settle(alarm)
        for alarm in active:
            since = self._since.setdefault(alarm, now)
            if alarm not in self._raised and now - since >= self._delay:
                self._raised.add(alarm)
                self._response.raise_(alarm, now)


@dataclass(frozen=True, slots=True)
class BrakingAlarm:
    """An alarm, the public names of the streams that are gone past, and who goes past them.

    `endpoints` are GIDs.
    """

    alarm: Alarm
    streams: tuple[str, ...]
    endpoints: frozenset[bytes] = frozenset()


class BrakingAlarms:
    """Raises what is found at each look, and settles what is found no more."""

    def __init__(self, response: AuditResponse) -> None:
        self._response = response
        self._active: dict[Alarm, BrakingAlarm] = {}

    def update(self, found: Iterable[BrakingAlarm], now: int, planned: frozenset[bytes]) -> None:
        """Take all that is wrong at `now`; an alarm about a `planned` endpoint was mistaken."""
        active = {each.alarm: each for each in found}
        before, self._active = self._active, active
        for alarm, each in active.items():
            if alarm not in before or before[alarm].streams != each.streams:
                self._response.raise_(alarm, now, *each.streams)
        for alarm in before.keys() - active.keys():
            if before[alarm].endpoints & planned:
                self._response.withdraw(alarm)
            else:
                self._response.settle(alarm)

    def is_active(self, found: BrakingAlarm) -> bool:
        """Tell whether an alarm was found at the last look, too."""
        return found.alarm in self._active

    def intruders(self, stream: str) -> frozenset[bytes]:
        """Return the GIDs of the endpoints that go past a stream."""
        found = (each.endpoints for each in self._active.values() if stream in each.streams)
        return frozenset().union(*found)
