"""The alarms that stand: raised once, told in the log and in the diagnostics, and settled."""

import logging
from typing import Protocol

from rtron.guard.core.log_throttle import LogThrottle
from rtron.vocabulary import Alarm

log = logging.getLogger(__name__)

_MAX_ALARMS = 256


class AlarmListener(Protocol):
    """Is told each alarm that is raised, and each that stands no more."""

    def __call__(self, alarm: Alarm, *, active: bool) -> None:
        """Take one."""


def _ignore_alarm(alarm: Alarm, *, active: bool) -> None:
    """Nobody listens."""


class Alarms:
    """What is wrong at this moment, and how often something was.

    Bounded: a stranger who makes one alarm after the other fills neither the memory nor the log;
    what finds no place is counted, and one of it is logged each second.
    """

    def __init__(self) -> None:
        self._active: dict[Alarm, int] = {}
        self._log_throttle = LogThrottle()
        self.raised = 0
        self.listener: AlarmListener = _ignore_alarm

    @property
    def active(self) -> tuple[Alarm, ...]:
        """The alarms that stand, the oldest first."""
        return tuple(self._active)

    def since(self, alarm: Alarm) -> int | None:
        """Return when an alarm was raised (ns), None if it does not stand."""
        return self._active.get(alarm)

    def raise_(self, alarm: Alarm, now: int) -> bool:
        """Raise an alarm; tell whether it is news."""
        if alarm in self._active:
            return False
        self.raised += 1
        has_room = len(self._active) < _MAX_ALARMS
        if has_room:
            self._active[alarm] = now
        if has_room or self._log_throttle.allows("no place", now):
            log.error("alarm: %s: %s", alarm.kind, alarm.reason)
            self.listener(alarm, active=True)
        return True

    def clear(self, alarm: Alarm) -> None:
        """Take back an alarm; nothing if it does not stand."""
        if self._active.pop(alarm, None) is not None:
            log.warning("no more: %s: %s", alarm.kind, alarm.reason)
            self.listener(alarm, active=False)
