"""What follows from what the audit finds: alarms, and the brakes where the plan says so."""

from collections import defaultdict
from collections.abc import Iterator
from typing import Protocol

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport
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


class Brakes(Protocol):
    """The brakes of enforced streams, by their public names."""

    def hold(self, topic: str, why: str) -> None:
        """Let nothing of a stream pass and keep the robot stopped."""
        ...

    def release(self, topic: str) -> None:
        """Let pass again what the policies let pass."""
        ...

    def repeat_stop(self, topic: str) -> None:
        """Tell a stop to a node that has just begun to listen."""
        ...


class AuditBrakes:
    """The brakes of a host's enforced streams."""

    def __init__(self, host: Coordinator, transport: Transport) -> None:
        self._encoding = transport.encoding
        enforced = [each for each in host.streams if each.spec.mode is Mode.ENFORCE]
        self._types = {each.spec.type for each in enforced}
        self._brakes = [(each.spec.topic, AuditBrake(each, transport)) for each in enforced]

    def prepare(self) -> None:
        """Read the definitions that a brake needs: the first of them takes a third of a second."""
        for type in self._types:
            standard_info(type, self._encoding)

    def hold(self, topic: str, why: str) -> None:
        """Let nothing of a stream pass and keep the robot stopped."""
        for brake in self._of(topic):
            brake.hold(why)

    def release(self, topic: str) -> None:
        """Let pass again what the policies let pass."""
        for brake in self._of(topic):
            brake.release()

    def repeat_stop(self, topic: str) -> None:
        """Tell a stop to a node that has just begun to listen."""
        for brake in self._of(topic):
            brake.repeat_stop()

    def _of(self, topic: str) -> Iterator[AuditBrake]:
        return (brake for name, brake in self._brakes if name == topic)


class AlarmResponse:
    """Raises and settles alarms; a stream is braked for as long as one that brakes it stands.

    In a dry run, and where the plan says `on_foreign: alarm`, nothing is braked.
    """

    def __init__(
        self, alarms: Alarms, brakes: Brakes, on_foreign: OnForeign, *, dry_run: bool
    ) -> None:
        self.stops_streams = on_foreign is OnForeign.STOP and not dry_run
        self._alarms = alarms
        self._brakes = brakes
        self._braking: dict[str, set[Alarm]] = defaultdict(set)

    def raise_(self, alarm: Alarm, now: int, *guarded: str) -> None:
        """Raise an alarm; brake the streams of these topics until it is settled."""
        self._alarms.raise_(alarm, now)
        for topic in guarded if self.stops_streams else ():
            is_first = not self._braking[topic]
            self._braking[topic].add(alarm)
            if is_first:
                self._brakes.hold(topic, alarm.reason)

    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back, and release what only it has braked."""
        self._alarms.clear(alarm)
        for topic, alarms in self._braking.items():
            if alarm in alarms:
                alarms.remove(alarm)
                if not alarms:
                    self._brakes.release(topic)

    def on_new_listener(self, topic: str) -> None:
        """Take note that a node has begun to hear what the guard lets go of a stream."""
        self._brakes.repeat_stop(topic)
