"""Active alarms: each is raised once, logged, shown in the diagnostics, and cleared."""

import logging
from functools import partial
from typing import Protocol

from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND, Alarm, AlarmKind

log = logging.getLogger(__name__)

_MAX_ALARMS = 256
_MAX_UNREADABLE = 64
_MAX_REASON_LENGTH = 300
_CLEAR_AFTER = 10 * SECOND


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
        has_room = self._has_room(alarm)
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

    def mirror(self, alarm: Alarm, now: int, *, active: bool) -> None:
        """Take over an alarm of another process of the guard, which has logged it."""
        if active and alarm not in self._active and self._has_room(alarm):
            self._active[alarm] = now
            self.raised += 1
            self.listener(alarm, active=True)
        elif not active and self._active.pop(alarm, None) is not None:
            self.listener(alarm, active=False)

    def _has_room(self, alarm: Alarm) -> bool:
        """Tell whether there is room; a stream that an intruder has stopped always has it."""
        return alarm.kind is AlarmKind.INTRUSION or len(self._active) < _MAX_ALARMS


class UnreadableInputAlarms:
    """Raises an alarm for each topic and node; clears it after 10 s without a new report."""

    def __init__(self, alarms: Alarms, transport: Transport) -> None:
        self._alarms = alarms
        self._transport = transport
        self._last_report: dict[Alarm, int] = {}

    def report(self, topic: str, node: str, why: str) -> None:
        """Report that a message of a node on a topic cannot be read, and why.

        What follows the first colon differs from message to message, so it is only logged.
        """
        who = f"{topic}: {node or 'a node without a name'}"
        log.warning("%s %s", who, why[:_MAX_REASON_LENGTH])
        reason = f"{who} {why.partition(':')[0]}"[:_MAX_REASON_LENGTH]
        alarm = Alarm(kind=AlarmKind.UNREADABLE, reason=reason, topic=topic, peer=node)
        if alarm not in self._last_report and len(self._last_report) == _MAX_UNREADABLE:
            return
        now = self._transport.now()
        if alarm not in self._last_report:
            self._transport.call_at(now + _CLEAR_AFTER, partial(self._clear_if_calm, alarm))
        self._last_report[alarm] = now
        self._alarms.raise_(alarm, now)

    def _clear_if_calm(self, alarm: Alarm) -> None:
        due = self._last_report[alarm] + _CLEAR_AFTER
        if due <= self._transport.now():
            del self._last_report[alarm]
            self._alarms.clear(alarm)
        else:
            self._transport.call_at(due, partial(self._clear_if_calm, alarm))
