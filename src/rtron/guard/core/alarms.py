"""The alarms that stand: raised once, told in the log and in the diagnostics, and settled."""

import logging
from typing import Protocol

from rtron.guard.core.log_throttle import Seldom
from rtron.vocabulary import Alarm

log = logging.getLogger(__name__)

_MOST = 256


class Told(Protocol):
    """Is told each alarm that is raised, and each that stands no more."""

    def __call__(self, alarm: Alarm, *, stands: bool) -> None:
        """Take one."""


def _nobody(alarm: Alarm, *, stands: bool) -> None:
    """Nobody listens."""


class Alarms:
    """What is wrong at this moment, and how often something was.

    Bounded: a stranger who makes one alarm after the other fills neither the memory nor the log;
    what finds no place is counted, and one of it is logged each second.
    """

    def __init__(self) -> None:
        self._standing: dict[Alarm, int] = {}
        self._seldom = Seldom()
        self.raised = 0
        self.told: Told = _nobody

    @property
    def standing(self) -> tuple[Alarm, ...]:
        """The alarms that stand, the oldest first."""
        return tuple(self._standing)

    def since(self, alarm: Alarm) -> int | None:
        """Return when an alarm was raised (ns), None if it does not stand."""
        return self._standing.get(alarm)

    def raise_(self, alarm: Alarm, now: int) -> bool:
        """Raise an alarm; tell whether it is news."""
        if alarm in self._standing:
            return False
        self.raised += 1
        has_place = len(self._standing) < _MOST
        if has_place:
            self._standing[alarm] = now
        if has_place or self._seldom.may_say("no place", now):
            log.error("alarm: %s: %s", alarm.kind, alarm.reason)
            self.told(alarm, stands=True)
        return True

    def settle(self, alarm: Alarm) -> None:
        """Take back an alarm; nothing if it does not stand."""
        if self._standing.pop(alarm, None) is not None:
            log.warning("no more: %s: %s", alarm.kind, alarm.reason)
            self.told(alarm, stands=False)
