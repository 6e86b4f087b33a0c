"""What follows from what the audit finds: alarms, and the brakes where the plan says so."""

from collections import defaultdict
from collections.abc import Iterator

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import Alarm, Mode, OnForeign

_SOURCE = "the audit"


class AuditBrake:
    """Stops what a stream moves until `release`, and tells so for the plan's `repeat` after it.

    A node that begins to listen later is told too, while that stop is the stream's last word.
    """

    def __init__(self, guarded: GuardedStream, transport: Transport) -> None:
        self._guarded = guarded
        self._transport = transport
        self._is_held = False
        self._repeat_until = 0
        self._stop_count: int | None = None

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
    """Raises and settles alarms; a stream is braked for as long as one that brakes it stands.

    In a dry run, and where the plan says `on_foreign: alarm`, nothing is braked.
    """

    def __init__(
        self, host: Coordinator, transport: Transport, on_foreign: OnForeign, *, dry_run: bool
    ) -> None:
        self.stops_streams = on_foreign is OnForeign.STOP and not dry_run
        self._host = host
        self._braking: dict[str, set[Alarm]] = defaultdict(set)
        enforced = [each for each in host.streams if each.spec.mode is Mode.ENFORCE]
        self._brakes = [(each.spec.topic, AuditBrake(each, transport)) for each in enforced]

    def prepare(self, encoding: Encoding) -> None:
        """Read the definitions that a brake needs: the first of them takes a third of a second."""
        for guarded in self._host.streams if self.stops_streams else ():
            standard_info(guarded.spec.type, encoding)

    def raise_(self, alarm: Alarm, now: int, *guarded: str) -> None:
        """Raise an alarm; brake the streams of these topics until it is settled."""
        self._host.alarms.raise_(alarm, now)
        for topic in guarded if self.stops_streams else ():
            is_first = not self._braking[topic]
            self._braking[topic].add(alarm)
            for brake in self._brakes_of(topic) if is_first else ():
                brake.hold(alarm.reason)

    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back, and release what only it has braked."""
        self._host.alarms.clear(alarm)
        for topic, alarms in self._braking.items():
            if alarm in alarms:
                alarms.remove(alarm)
                for brake in () if alarms else self._brakes_of(topic):
                    brake.release()

    def on_new_listener(self, topic: str) -> None:
        """Take note that a node has begun to hear what the guard lets go of a stream."""
        for brake in self._brakes_of(topic):
            brake.repeat_stop()

    def _brakes_of(self, topic: str) -> Iterator[AuditBrake]:
        return (brake for name, brake in self._brakes if name == topic)
