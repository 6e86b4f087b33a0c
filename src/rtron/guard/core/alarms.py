"""Active alarms: each is raised once, logged, shown in the diagnostics, and cleared."""

import logging
from typing import Protocol

from rtron.guard.core.log_throttle import LogThrottle
from rtron.vocabulary import Alarm

log = logging.getLogger(__name__)

_MAX_ALARMS = 256


class AlarmListener(Protocol):
    """Called for each alarm that is raised or cleared."""

    def __call__(self, alarm: Alarm, *, active: bool) -> None:
        """Take an alarm; it is `active`, or was cleared."""


def _ignore_alarm(alarm: Alarm, *, active: bool) -> None:
    """Do nothing with an alarm."""


class Alarms:
    """The alarms that are active now, and the number of all that were raised.

    The number of active alarms is bounded, so a stranger can fill neither the memory nor the log.
    An alarm without room is counted; one of these is logged each second.
    """

    def __init__(self) -> None:
        self._active: dict[Alarm, int] = {}
        self._log_throttle = LogThrottle()
        self.raised = 0
        self.listener: AlarmListener = _ignore_alarm

    @property
    def active(self) -> tuple[Alarm, ...]:
        """The active alarms, the oldest first."""
        return tuple(self._active)

    def since(self, alarm: Alarm) -> int | None:
        """Return when an alarm was raised (ns), None if it is not active."""
        return self._active.get(alarm)

    def raise_(self, alarm: Alarm, now: int) -> bool:
        """Raise an alarm; return whether it was inactive before."""
        if alarm in self._active:
            return False
        self.raised += 1
        has_room = len(self._active) < _MAX_ALARMS
        if has_room:
            self._active[alarm] = now
        if has_room or self._log_throttle.allows("no room", now):
            log.error("alarm: %s: %s", alarm.kind, alarm.reason)
            self.listener(alarm, active=True)
        return True

    def clear(self, alarm: Alarm) -> None:
        """Clear an alarm; do nothing if it is not active."""
        if self._active.pop(alarm, None) is not None:
            log.warning("no more: %s: %s", alarm.kind, alarm.reason)
            self.listener(alarm, active=False)
