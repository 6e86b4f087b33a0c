"""Alarms for input that the transport cannot read."""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND, Alarm, AlarmKind

if TYPE_CHECKING:
    from rtron.guard.core.alarms import Alarms
    from rtron.guard.transport.common.protocol import Transport

log = logging.getLogger(__name__)

_CLEAR_AFTER = 10 * SECOND
_MAX_ALARMS = 64
_MAX_LENGTH = 300


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
        log.warning("%s %s", who, why[:_MAX_LENGTH])
        reason = f"{who} {why.partition(':')[0]}"[:_MAX_LENGTH]
        alarm = Alarm(kind=AlarmKind.UNREADABLE, reason=reason, topic=topic, peer=node)
        if alarm not in self._last_report and len(self._last_report) == _MAX_ALARMS:
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
