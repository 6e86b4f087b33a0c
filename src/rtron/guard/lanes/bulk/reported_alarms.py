"""The alarms that the audit reports to the brakes: strangers cause any number, messages are short.

What stops a stream is never lost: at least one alarm of each stream is reported.
"""

import logging

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.lanes.exchange.messages import MAX_ALARMS, RaiseAlarm
from rtron.vocabulary import Alarm

log = logging.getLogger(__name__)


class ReportedAlarms:
    """Keeps the alarms that are there, and tells which of them are reported.

    One that stops nothing and has no room is lost. One that stops a stream for which another is
    reported waits for room, so that the stream is not cleared when the others are settled.
    """

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop
        self._stopping: dict[Alarm, RaiseAlarm] = {}
        self._others: dict[Alarm, RaiseAlarm] = {}
        self._waiting: dict[Alarm, RaiseAlarm] = {}
        self._lost_count = 0
        self._log_throttle = LogThrottle()

    def messages(self) -> tuple[RaiseAlarm, ...]:
        """Return what is reported, what stops streams first."""
        return (*self._stopping.values(), *self._others.values())

    def add(self, message: RaiseAlarm) -> bool:
        """Keep an alarm; return whether to report it: it is new or stops others than before."""
        alarm = message.alarm
        if message in (self._stopping.get(alarm), self._others.get(alarm)):
            return False
        if not self._has_room(message):
            self._postpone(message)
            return False
        self._waiting.pop(alarm, None)
        former, group = self._others, self._stopping
        if not message.streams:
            former, group = group, former
        former.pop(alarm, None)
        group[alarm] = message
        return True

    def remove(self, alarm: Alarm) -> bool:
        """Forget an alarm; return whether it was reported."""
        self._waiting.pop(alarm, None)
        stopping, other = self._stopping.pop(alarm, None), self._others.pop(alarm, None)
        return bool(stopping or other)

    def take_waiting(self) -> list[RaiseAlarm]:
        """Return what has room by now and is reported from now on."""
        return [each for each in list(self._waiting.values()) if self.add(each)]

    def _has_room(self, message: RaiseAlarm) -> bool:
        if not message.streams:
            return message.alarm in self._others or len(self._others) < MAX_ALARMS
        if message.alarm in self._stopping or len(self._stopping) < MAX_ALARMS:
            return True
        stopped = {topic for each in self._stopping.values() for topic in each.streams}
        return not stopped.issuperset(message.streams)

    def _postpone(self, message: RaiseAlarm) -> None:
        if message.streams:
            self._waiting[message.alarm] = message
            return
        self._lost_count += 1
        if self._log_throttle.allows("lost", self._loop.now()):
            text = "%d alarms are not reported, %d are: %s"
            log.error(text, self._lost_count, MAX_ALARMS, message.alarm.reason)
