"""The response to what the audit finds, as the bulk process sees it: messages to the brakes."""

import logging

from rtron.guard.audit.common.audit_response import AuditResponse, ListenRequest, ListenToPublisher
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.lanes.bulk.command_connection import CommandConnection
from rtron.guard.lanes.exchange.audit_exchange import MAX_ALARMS, StoppedTopics
from rtron.vocabulary import Alarm

log = logging.getLogger(__name__)

CHECK_S = 0.5
"""How often the audit is asked whether it has looked at everything, s."""
_MAX_REQUESTS = 32


class RemoteResponse(AuditResponse):
    """Tells the command process what the audit finds, on change.

    A command process that connects is told all that is there. It is called complete when the audit
    has looked at everything since then: an intruder that is not found yet is not gone.
    """

    def __init__(
        self, connection: CommandConnection, loop: EventLoop, *, stops_streams: bool
    ) -> None:
        super().__init__()
        self.stops_streams = stops_streams
        self._call = connection.call
        self._round_at = loop.now()
        self._loop = loop
        self._active = ReportedAlarms(loop)
        self._requests: dict[tuple[str, ...], ListenRequest] = {}
        self._stopped: frozenset[str] = frozenset()
        self._missing = ""
        self._is_complete = False
        connection.on(
            stopped_streams=self._take_stopped,
            dismiss=self._answer,
            intruder_returned=lambda gid: self.on_return(gid),  # noqa: PLW0108 - set later
        )
        connection.connect_listeners.append(self._report_all)

    def open(self) -> None:
        """Tell each round of the audit, and once when it has looked at everything."""
        self._loop.call_later(CHECK_S, self.open)
        since, self._round_at = self._round_at, self._loop.now()
        self._call("audit_round", self.find_unseen(since))
        if not self._is_complete:
            self._report_progress()

    def close(self) -> None:
        """Do nothing; the connection ends with the process."""

    def raise_(self, alarm: Alarm, now: int, *guarded: str) -> None:
        """Raise an alarm; stop the streams of these topics until a person clears them."""
        del now
        if self._active.add(alarm, guarded):
            self._call("raise_alarm", alarm, guarded)

    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back: its cause is gone."""
        self._take_back(alarm, "settle_alarm")

    def withdraw(self, alarm: Alarm) -> None:
        """Take an alarm back that was mistaken."""
        self._take_back(alarm, "withdraw_alarm")

    def _take_back(self, alarm: Alarm, call: str) -> None:
        """Take an alarm back, after those that have room now: they keep its streams stopped."""
        if self._active.remove(alarm):
            for each in self._active.take_waiting():
                self._call("raise_alarm", *each)
            self._call(call, alarm)

    @property
    def stopped_streams(self) -> frozenset[str]:
        """The streams that intruders have stopped, as the command process has told."""
        return self._stopped

    def listen(self, request: ListenRequest) -> None:
        """Let the command process listen to intruders.

        An request that is the same is told again, too: the intruder may have hung up.
        """
        self._requests.pop(request.subject, None)
        self._requests[request.subject] = request
        while len(self._requests) > _MAX_REQUESTS:
            del self._requests[next(each for each in self._requests if each)]
        self._call("listen", request)

    def on_new_listener(self, topic: str) -> None:
        """Let the command process tell a stop to a node that has just begun to listen."""
        self._call("repeat_stop", topic)

    def _report_progress(self) -> None:
        """Tell what is missing, if it is something else than before; at the end, all alarms."""
        before, self._missing = self._missing, self.find_missing()
        if not self._missing:
            self._is_complete = True
            self._call("active_alarms", self._active.reported())
        elif self._missing != before:
            self._call("audit_progress", self._missing)

    def _report_all(self) -> None:
        """Tell a new command process what is there; the audit does not know its nodes yet."""
        self._is_complete, self._missing = False, ""
        for each in self._active.reported():
            self._call("raise_alarm", *each)
        for request in self._requests.values():
            self._call("listen", request)

    def _take_stopped(self, topics: frozenset[str]) -> None:
        self._stopped = topics
        self._forget_requests()

    def _answer(self, number: int, topic: str, is_audible: bool) -> None:  # noqa: FBT001 - as `dismiss`
        self._call("dismiss_answer", number, self.dismiss(topic, is_audible))

    def _forget_requests(self) -> None:
        """Forget whom to listen to where nothing is stopped any more."""
        self._requests = {
            subject: request
            for subject, request in self._requests.items()
            if not isinstance(request, ListenToPublisher) or request.stream in self._stopped
        }


class ReportedAlarms:
    """Keeps the alarms that are there, and tells which are reported: strangers cause any number.

    One that stops nothing and has no room is lost. One that stops a stream for which another is
    reported waits for room, so that the stream is not cleared when the others are settled.
    """

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop
        self._stopping: dict[Alarm, StoppedTopics] = {}
        self._others: dict[Alarm, StoppedTopics] = {}
        self._waiting: dict[Alarm, StoppedTopics] = {}
        self._lost_count = 0
        self._log_throttle = LogThrottle()

    def reported(self) -> tuple[tuple[Alarm, StoppedTopics], ...]:
        """Return what is reported and the streams that it stops, those that stop any first."""
        return (*self._stopping.items(), *self._others.items())

    def add(self, alarm: Alarm, streams: StoppedTopics) -> bool:
        """Keep an alarm; return whether to report it: it is new or stops others than before."""
        group, former = self._stopping, self._others
        if not streams:
            group, former = former, group
        if group.get(alarm) == streams:
            return False
        if not self._has_room(alarm, streams):
            self._postpone(alarm, streams)
            return False
        for each in (self._waiting, former):
            each.pop(alarm, None)
        group[alarm] = streams
        return True

    def remove(self, alarm: Alarm) -> bool:
        """Forget an alarm; return whether it was reported."""
        self._waiting.pop(alarm, None)
        groups = (self._stopping, self._others)
        found = [group.pop(alarm, None) for group in groups]
        return found != [None, None]

    def take_waiting(self) -> list[tuple[Alarm, StoppedTopics]]:
        """Return what has room by now and is reported from now on."""
        return [each for each in list(self._waiting.items()) if self.add(*each)]

    def _has_room(self, alarm: Alarm, streams: StoppedTopics) -> bool:
        if not streams:
            return alarm in self._others or len(self._others) < MAX_ALARMS
        if alarm in self._stopping or len(self._stopping) < MAX_ALARMS:
            return True
        stopped = {topic for each in self._stopping.values() for topic in each}
        return not stopped.issuperset(streams)

    def _postpone(self, alarm: Alarm, streams: StoppedTopics) -> None:
        if streams:
            self._waiting[alarm] = streams
            return
        self._lost_count += 1
        if self._log_throttle.allows("lost", self._loop.now()):
            text = "%d alarms are not reported, %d are: %s"
            log.error(text, self._lost_count, MAX_ALARMS, alarm.reason)
