"""The audit in the bulk process, as the command process sees it: its findings and its answers.

What an audit has found counts until the next one knows better: neither a bulk process that ends nor
one that begins makes an intruder go away.
"""

import logging
from functools import partial
from itertools import count

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.intrusion_latch import OnRefusal
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.lanes.exchange.audit_exchange import MAX_ALARMS, StoppedTopics
from rtron.vocabulary import Alarm

log = logging.getLogger(__name__)

ANSWER_LIMIT_S = 2.0
"""How long a person waits for the audit's answer, s."""
_AGAIN = "try again in a few seconds"
NOT_CONNECTED = f"the audit is not connected: nobody knows whether the intruder is gone; {_AGAIN}"
_JUST_BEGUN = f"the audit has just begun: it does not know whether the intruder is gone; {_AGAIN}"
_NO_ANSWER = f"the audit has not answered within {ANSWER_LIMIT_S:g} s; {_AGAIN}"


class RemoteAudit:
    """Does what the audit says, and asks it before a person clears a stream."""

    def __init__(
        self, connection: BulkConnection, response: AlarmResponse, loop: EventLoop
    ) -> None:
        self._connection = connection
        self._response = response
        self._loop = loop
        self._alarms: dict[Alarm, StoppedTopics] = {}
        """What an audit has found, this one or one before it, and the streams that it stops."""
        self._log_throttle = LogThrottle()
        self._is_complete = False
        self._missing = ""
        """What the audit has not looked at yet, as it told last."""
        self._numbers = count()
        self._requests: dict[int, OnRefusal] = {}
        response.query_audit = self._query
        response.on_return = partial(connection.call, "intruder_returned")
        response.change_listeners.append(self._report_stopped)
        connection.on(
            raise_alarm=self._raise,
            settle_alarm=self._settle,
            withdraw_alarm=self._withdraw,
            active_alarms=self._take_all,
            audit_progress=self._take_progress,
            dismiss_answer=self._answer,
            repeat_stop=response.on_new_listener,
            listen=response.listen,
        )
        connection.connect_listeners.append(self._report_stopped)
        connection.loss_listeners.append(self._on_lost)

    def _query(self, topic: str, is_audible: bool, on_refusal: OnRefusal) -> None:  # noqa: FBT001 - as `dismiss`
        if not self._connection.is_connected:
            on_refusal(NOT_CONNECTED)
        elif not self._is_complete:
            on_refusal(_incomplete(self._missing) if self._missing else _JUST_BEGUN)
        else:
            number = next(self._numbers)
            self._requests[number] = on_refusal
            self._loop.call_later(ANSWER_LIMIT_S, lambda: self._answer(number, _NO_ANSWER))
            self._connection.call("dismiss", number, topic, is_audible)

    def _answer(self, number: int, refusal: str) -> None:
        """Tell what the audit has said; later words about the same request do not count."""
        if on_refusal := self._requests.pop(number, None):
            on_refusal(refusal)

    def _withdraw(self, alarm: Alarm) -> None:
        self._alarms.pop(alarm, None)
        self._response.withdraw(alarm)

    def _take_progress(self, missing: str) -> None:
        self._missing = missing

    def _raise(self, alarm: Alarm, streams: StoppedTopics) -> None:
        if self._has_room(alarm, streams):
            self._alarms[alarm] = streams
            self._response.raise_(alarm, self._loop.now(), *streams)
        elif self._log_throttle.allows("no room", self._loop.now()):
            log.error("an alarm has no room beside %d others: %s", MAX_ALARMS, alarm.reason)

    def _has_room(self, alarm: Alarm, streams: StoppedTopics) -> bool:
        """Tell whether there is room for an alarm; what stops a stream always has it."""
        others = sum(not each for each in self._alarms.values())
        return bool(streams) or alarm in self._alarms or others < MAX_ALARMS

    def _settle(self, alarm: Alarm) -> None:
        self._alarms.pop(alarm, None)
        self._response.settle(alarm)

    def _take_all(self, alarms: tuple[tuple[Alarm, StoppedTopics], ...]) -> None:
        """Take all that the audit has found and that is still there; what is not here is gone."""
        if not self._is_complete:
            log.info("the audit has looked at the whole graph")
        self._is_complete = True
        for alarm, streams in alarms:
            self._raise(alarm, streams)
        for alarm in self._alarms.keys() - {alarm for alarm, _ in alarms}:
            self._settle(alarm)

    def _report_stopped(self) -> None:
        self._connection.call("stopped_streams", self._response.stopped_streams)

    def _on_lost(self) -> None:
        self._is_complete, self._missing = False, ""
        for number in list(self._requests):
            self._answer(number, NOT_CONNECTED)


def _incomplete(missing: str) -> str:
    return f"the audit has not looked at everything, so the intruder may be there: {missing}"


class RemoteBrake:
    """The brake of a stream in the bulk process; a new one is told, too."""

    is_ready = False
    """What an intruder says on such a stream is not answered: it moves no robot."""

    def __init__(self, topic: str, connection: BulkConnection) -> None:
        self._topic = topic
        self._connection = connection
        self._why = ""
        connection.connect_listeners.append(self._hold_again)

    def hold(self, why: str) -> None:
        """Let nothing pass."""
        self._why = why
        self._connection.call("hold", self._topic, why)

    def release(self) -> None:
        """Let pass again what the policies let pass."""
        self._why = ""
        self._connection.call("release", self._topic)

    def answer(self, message: bytes) -> None:
        """Do nothing."""

    def repeat_stop(self) -> None:
        """Tell the stop to a node that has just begun to listen."""
        self._connection.call("repeat_stop", self._topic)

    def _hold_again(self) -> None:
        if self._why:
            self.hold(self._why)
