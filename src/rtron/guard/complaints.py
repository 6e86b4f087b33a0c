"""What the transport could not read of others, as alarms that stand while it goes on."""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND, Alarm, AlarmKind

if TYPE_CHECKING:
    from rtron.guard.core.alarms import Alarms
    from rtron.guard.transport.common.protocol import Transport

log = logging.getLogger(__name__)

_CALM = 10 * SECOND
_MOST = 64
_LONGEST = 300


class Complaints:
    """Raises an alarm for each topic and node; settles it when nothing was wrong for 10 s."""

    def __init__(self, alarms: Alarms, transport: Transport) -> None:
        self._alarms = alarms
        self._transport = transport
        self._last: dict[Alarm, int] = {}

    def take(self, topic: str, node: str, why: str) -> None:
        """Tell that something a node says on a topic is not heard, and why.

        What stands behind a colon differs from message to message and is only logged.
        """
        who = f"{topic}: {node or 'a node without a name'}"
        log.warning("%s %s", who, why[:_LONGEST])
        reason = f"{who} {why.partition(':')[0]}"[:_LONGEST]
        alarm = Alarm(kind=AlarmKind.UNREADABLE, reason=reason, topic=topic, peer=node)
        if alarm not in self._last and len(self._last) == _MOST:
            return
        now = self._transport.now()
        if alarm not in self._last:
            self._transport.call_at(now + _CALM, partial(self._look, alarm))
        self._last[alarm] = now
        self._alarms.raise_(alarm, now)

    def _look(self, alarm: Alarm) -> None:
        due = self._last[alarm] + _CALM
        if due <= self._transport.now():
            del self._last[alarm]
            self._alarms.settle(alarm)
        else:
            self._transport.call_at(due, partial(self._look, alarm))
