"""The stop of a stream after which the audit has not looked: an intruder would not be found."""

import logging
from collections.abc import Iterable, Mapping

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.stream import GuardedStream
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.vocabulary import SECOND, Alarm, AlarmKind, Mode, OnForeign, Plan

log = logging.getLogger(__name__)

_CHECK_S = 1.0
_SOURCE = "no audit"
_NO_ANSWER = "the audit does not answer"
_KEY = "audited"


class AuditWatchdog:
    """Raises an alarm for each stream that is not looked after, and keeps it stopped.

    The time is this process's own: an audit that hangs, that gets no answers, or that ends before
    its first round, again and again, is late in the same way. The next guard inherits when each
    stream was looked after last: guards that end one after the other are late together.
    """

    def __init__(
        self,
        connection: BulkConnection,
        host: Coordinator,
        loop: EventLoop,
        plan: Plan,
        handover: HandoverState,
    ) -> None:
        """Take from the plan how long a stream may go on, and whether it is stopped then."""
        self._host = host
        self._loop = loop
        self._limit = plan.supervision.audit_within
        self._stops_streams = plan.audit.on_foreign is OnForeign.STOP
        enforced = [each for each in host.streams if each.spec.mode is Mode.ENFORCE]
        self._streams = {each.spec.topic: each for each in enforced}
        self._handover = handover
        self._seen_at = _inherited_times(handover, self._streams, loop.now())
        self._gaps: dict[str, str] = {}
        """Why a stream was not looked after in the last round."""
        self._alarms: dict[str, Alarm] = {}
        connection.on(audit_round=self._note_round)
        connection.loss_listeners.append(self._gaps.clear)

    def open(self) -> None:
        """Look from now on."""
        self._loop.call_later(_CHECK_S, self.open)
        now = self._loop.now()
        for topic, stream in self._streams.items():
            is_late = now - self._seen_at[topic] > self._limit
            if is_late and topic not in self._alarms:
                self._hold(topic, stream)
            elif not is_late and topic in self._alarms:
                self._release(topic, stream)
        self._handover.store(_KEY, self._seen_at)

    def close(self) -> None:
        """Look no more."""

    def _note_round(self, unseen: Mapping[str, str]) -> None:
        """Take that the audit has looked after all streams since the last round, but for some."""
        self._gaps.update(unseen)
        for topic in self._streams.keys() - unseen.keys():
            self._seen_at[topic] = self._loop.now()
            self._gaps.pop(topic, None)

    def _hold(self, topic: str, stream: GuardedStream) -> None:
        seconds, gap = self._limit / SECOND, self._gaps.get(topic, _NO_ANSWER)
        reason = f"nobody has looked for intruders for {seconds:g} s: {gap}"
        alarm = Alarm(kind=AlarmKind.UNREACHABLE, reason=f"{topic}: {reason}", topic=topic)
        self._alarms[topic] = alarm
        self._host.alarms.raise_(alarm, self._loop.now())
        if self._stops_streams:
            stream.brake(_SOURCE, reason)

    def _release(self, topic: str, stream: GuardedStream) -> None:
        self._host.alarms.clear(self._alarms.pop(topic))
        if self._stops_streams:
            stream.release(_SOURCE)


def _inherited_times(handover: HandoverState, topics: Iterable[str], now: int) -> dict[str, int]:
    """Return when each stream was looked after last, ns: now, if no guard before has told it."""
    stored = handover.inherited(_KEY)
    times = stored if isinstance(stored, dict) else {}
    inherited = {topic: times.get(topic) for topic in topics}
    return {k: min(v, now) if isinstance(v, int) else now for k, v in inherited.items()}
