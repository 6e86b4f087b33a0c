"""What follows from what the audit finds: alarms, and the brakes where the plan says so."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from functools import partial

from rtron.guard.audit.common.audit_brake import AuditBrake, Brake
from rtron.guard.audit.common.audit_response import AuditResponse, IntruderListener, ListenRequest
from rtron.guard.coordinator import Coordinator
from rtron.guard.intrusion_latch import OnRefusal
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND, Alarm, AlarmKind, Mode, OnForeign

_MAX_CAUSES = 64
_HAS_SPOKEN = "an intruder has spoken within the last second"
_HAS_RETURNED = "an intruder that was taken for gone speaks again"
_SILENCE = SECOND
"""How long no intruder must have been heard before a person may clear what it has stopped (ns)."""


class AlarmResponse(AuditResponse):
    """Raises and settles alarms, and stops what an intruder can move until a person clears it.

    The stop outlives the intruder and the guard. In a dry run, and where the plan says
    `on_foreign: alarm`, nothing is stopped.
    """

    def __init__(
        self,
        host: Coordinator,
        transport: Transport,
        on_foreign: OnForeign,
        *,
        dry_run: bool,
        others: Mapping[str, Brake] | None = None,
    ) -> None:
        """`others` are the brakes of the streams in other processes of the guard, by name."""
        super().__init__()
        self.stops_streams = on_foreign is OnForeign.STOP and not dry_run
        self.query_audit: Callable[[str, bool, OnRefusal], None] = self._query_here
        """Asks the audit, wherever it is, to `dismiss`; the answer may come later."""
        self.change_listeners: list[Callable[[], None]] = []
        """Called when `stopped_streams` has changed."""
        self.listener: IntruderListener | None = None
        """Listens to intruders in this process."""
        self._host = host
        self._transport = transport
        self._braking: dict[str, set[Alarm]] = defaultdict(set)
        self._causes: dict[str, set[Alarm]] = defaultdict(set)
        self._intrusion_alarms: dict[str, Alarm] = {}
        enforced = [each for each in host.streams if each.spec.mode is Mode.ENFORCE]
        self._brakes: list[tuple[str, Brake]] = [
            *((each.spec.topic, AuditBrake(each, transport)) for each in enforced),
            *(others or {}).items(),
        ]
        if self.stops_streams:
            host.intrusions.clear = self._clear
            self._inherit()

    def raise_(self, alarm: Alarm, now: int, *guarded: str) -> None:
        """Raise an alarm; stop the streams of these topics until a person clears them."""
        self._host.alarms.raise_(alarm, now)
        for topic in guarded if self.stops_streams else ():
            self._braking[topic].add(alarm)
            if topic not in self._intrusion_alarms:
                self._stop(topic, alarm.reason)
            is_full = len(self._causes[topic]) >= _MAX_CAUSES
            self._causes[topic].add(self._intrusion_alarms[topic] if is_full else alarm)

    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back: its cause is gone. What it has stopped stays stopped."""
        self._host.alarms.clear(alarm)
        for alarms in self._braking.values():
            alarms.discard(alarm)

    def withdraw(self, alarm: Alarm) -> None:
        """Take an alarm back that was mistaken, and release what only mistakes have stopped."""
        self.settle(alarm)
        for causes in self._causes.values():
            causes.discard(alarm)
        for topic in [each for each, causes in self._causes.items() if not causes]:
            self._release(topic)

    @property
    def stopped_streams(self) -> frozenset[str]:
        """The streams that intruders have stopped and nobody has cleared."""
        return frozenset(self._intrusion_alarms)

    def listen(self, request: ListenRequest) -> None:
        """Listen to intruders as the audit asks, and answer them."""
        if self.listener:
            self.listener.follow(request)

    def has_stop(self, topic: str) -> bool:
        """Tell whether the guard can stop what a stream moves."""
        return any(brake.is_ready for brake in self._brakes_of(topic))

    def note_return(self, topic: str, gid: bytes) -> None:
        """Stop a stream at once whose intruder was taken for gone and speaks; tell the audit."""
        if self.stops_streams and topic not in self._intrusion_alarms:
            self._stop_for(topic, _HAS_RETURNED)
        self.on_return(gid)

    def answer(self, topic: str, message: bytes) -> None:
        """Answer a message that an intruder has sent past the guard: with the stop, at once."""
        for brake in self._brakes_of(topic):
            brake.answer(message)

    def on_new_listener(self, topic: str) -> None:
        """Take note that a node has begun to hear what the guard lets go of a stream."""
        for brake in self._brakes_of(topic):
            brake.repeat_stop()

    def _inherit(self) -> None:
        """Go on with the stops that the guard before has left, before the streams open."""
        topics = {topic for topic, _ in self._brakes}
        for topic, reason in self._host.intrusions.reasons.items():
            if topic in topics:
                self._stop_for(topic, reason)

    def _stop_for(self, topic: str, reason: str) -> None:
        """Stop a stream although the audit here has no alarm for it."""
        self._stop(topic, reason)
        self._causes[topic].add(self._intrusion_alarms[topic])

    def _stop(self, topic: str, reason: str) -> None:
        self._host.intrusions.add(topic, reason)
        text = f"{topic} is stopped until somebody clears it with `rtron clear`: {reason}"
        alarm = Alarm(kind=AlarmKind.INTRUSION, reason=text, topic=topic)
        self._intrusion_alarms[topic] = alarm
        self._host.alarms.raise_(alarm, self._transport.now())
        for brake in self._brakes_of(topic):
            brake.hold(reason)
        self._notify_change()

    def _clear(self, topic: str, on_refusal: OnRefusal) -> None:
        """Release a stream unless an intruder is still there; tell why it is not released."""
        silence = self._silence(topic)
        if silence is not None and silence < _SILENCE:
            on_refusal(_HAS_SPOKEN)
        else:
            on_answer = partial(self._finish_clear, topic, on_refusal)
            self.query_audit(topic, silence is not None, on_answer)

    def _silence(self, topic: str) -> int | None:
        """Return for how long (ns) no intruder was heard, None if none could be."""
        return self.listener.silence(topic) if self.listener else None

    def _query_here(self, topic: str, is_audible: bool, on_refusal: OnRefusal) -> None:  # noqa: FBT001 - as `dismiss`
        on_refusal(self.dismiss(topic, is_audible))

    def _finish_clear(self, topic: str, on_refusal: OnRefusal, refusal: str) -> None:
        silence = self._silence(topic)
        if topic not in self._intrusion_alarms:
            refusal = "somebody else has just cleared it"
        elif silence is not None and silence < _SILENCE:
            refusal = _HAS_SPOKEN
        elif not refusal and self._braking[topic]:
            refusal = next(iter(self._braking[topic])).reason
        if not refusal:
            self._release(topic)
        on_refusal(refusal)

    def _release(self, topic: str) -> None:
        self._causes.pop(topic, None)
        self._host.intrusions.remove(topic)
        if alarm := self._intrusion_alarms.pop(topic, None):
            self._host.alarms.clear(alarm)
            for brake in self._brakes_of(topic):
                brake.release()
            self._notify_change()

    def _notify_change(self) -> None:
        if self.listener:
            self.listener.update()
        for listener in self.change_listeners:
            listener()

    def _brakes_of(self, topic: str) -> Iterator[Brake]:
        return (brake for name, brake in self._brakes if name == topic)
