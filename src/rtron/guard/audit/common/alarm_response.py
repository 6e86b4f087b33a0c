"""What follows from what the audit finds: alarms, and the brakes where the plan says so."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND, Alarm, AlarmKind, Mode, OnForeign

_SOURCE = "the audit"
_ANSWER_PERIOD = SECOND // 1000
_MAX_CAUSES = 64


class Brake(Protocol):
    """The brake of one stream; see `AuditBrake`."""

    @property
    def is_ready(self) -> bool:
        """Whether the guard knows here what stops the robot."""
        ...

    def hold(self, why: str) -> None:
        """Let nothing pass and keep the robot stopped."""
        ...

    def release(self) -> None:
        """Let pass again what the policies let pass."""
        ...

    def answer(self, message: bytes) -> None:
        """Answer a message of an intruder."""
        ...

    def repeat_stop(self) -> None:
        """Tell the stop to a node that has just begun to listen."""
        ...


class AuditBrake:
    """Stops what a stream moves until `release`, and tells so for the plan's `repeat` after it.

    A node that begins to listen later is told too, while that stop is the stream's last word. What
    an intruder says meanwhile is answered with the stop.
    """

    def __init__(self, guarded: GuardedStream, transport: Transport) -> None:
        self._guarded = guarded
        self._transport = transport
        self._is_held = False
        self._repeat_until = 0
        self._stop_count: int | None = None
        self._next_answer = 0
        self._is_answer_due = False

    @property
    def is_ready(self) -> bool:
        """Whether the guard knows what stops the robot."""
        return self._guarded.stop_controller.is_ready

    def hold(self, why: str) -> None:
        """Let nothing pass and keep the robot stopped."""
        self._is_held = True
        self._brake(why)

    def release(self) -> None:
        """Let pass again what the policies let pass, which ends the stop; without it, go on."""
        self._is_held = False
        if self._guarded.stop_controller.is_ready:
            self._resume()
        else:
            self._guarded.release(_SOURCE)

    def answer(self, message: bytes) -> None:
        """Send the stop once more, at once, after a message of an intruder that moves the robot.

        At most 1,000 times a second; the last message is answered all the same. A stop needs no
        answer, so two guards do not answer each other.
        """
        if self._is_answer_due or not self._guarded.stop_controller.is_moving(message):
            return
        self._is_answer_due = True
        now = self._transport.now()
        if now >= self._next_answer:
            self._send_answer()
        else:
            self._transport.call_at(self._next_answer, self._send_answer)

    def _send_answer(self) -> None:
        now = self._transport.now()
        self._is_answer_due, self._next_answer = False, now + _ANSWER_PERIOD
        if self._is_held:
            self._guarded.stop_controller.repeat(now)

    def repeat_stop(self) -> None:
        """Tell the stop to a node that has just begun to listen, if nothing was said since."""
        if not self._is_held and self._is_last_message:
            self._brake("a node listens that may have missed the stop")
            self._resume()

    @property
    def _is_last_message(self) -> bool:
        stopper = self._guarded.stop_controller
        return (
            stopper.is_ready
            and stopper.moving_flow is None
            and self._stop_count == stopper.stop_count
        )

    def _brake(self, why: str) -> None:
        self._guarded.brake(_SOURCE, why)
        self._stop_count = self._guarded.stop_controller.stop_count

    def _resume(self) -> None:
        self._guarded.pipeline.unbar(_SOURCE)
        self._repeat_until = self._transport.now() + self._guarded.spec.stop.repeat
        self._transport.call_at(self._repeat_until, self._end)

    def _end(self) -> None:
        """Let the stop come to its end, unless there is a reason by now that it goes on."""
        if not self._is_held and self._transport.now() >= self._repeat_until:
            self._guarded.release(_SOURCE)


class AlarmResponse:
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
        self.stops_streams = on_foreign is OnForeign.STOP and not dry_run
        self.dismiss: Callable[[str], str] = lambda topic: ""
        """Takes the intruders of a stream that say nothing any more for gone; returns why not."""
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

    def has_stop(self, topic: str) -> bool:
        """Tell whether the guard can stop what a stream moves."""
        return any(brake.is_ready for brake in self._brakes_of(topic))

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

    def _clear(self, topic: str) -> str:
        """Release a stream unless an intruder is still there; return why it is not released."""
        refusal = self.dismiss(topic)
        if not refusal and self._braking[topic]:
            refusal = next(iter(self._braking[topic])).reason
        if not refusal:
            self._release(topic)
        return refusal

    def _release(self, topic: str) -> None:
        self._causes.pop(topic, None)
        self._host.intrusions.remove(topic)
        if alarm := self._intrusion_alarms.pop(topic, None):
            self._host.alarms.clear(alarm)
            for brake in self._brakes_of(topic):
                brake.release()

    def _brakes_of(self, topic: str) -> Iterator[Brake]:
        return (brake for name, brake in self._brakes if name == topic)
