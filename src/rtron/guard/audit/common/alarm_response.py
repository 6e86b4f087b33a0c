"""What follows from what the audit finds: alarms, and the brakes where the plan says so."""

from collections import defaultdict
from collections.abc import Iterator

from rtron.guard.audit.common.audit_brake import Brake
from rtron.guard.core.coordinator import Host
from rtron.guard.core.message_types import standard_info
from rtron.guard.transport.common.protocol import Transport
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import Alarm, Mode, OnForeign


class Response:
    """Raises and settles alarms; a stream is braked for as long as one that brakes it stands.

    In a dry run, and where the plan says `on_foreign: alarm`, nothing is braked.
    """

    def __init__(
        self, host: Host, transport: Transport, on_foreign: OnForeign, *, dry_run: bool
    ) -> None:
        self.stops = on_foreign is OnForeign.STOP and not dry_run
        self._host = host
        self._braking: dict[str, set[Alarm]] = defaultdict(set)
        enforced = [each for each in host.guarded if each.stream.mode is Mode.ENFORCE]
        self._brakes = [(each.stream.topic, Brake(each, transport)) for each in enforced]

    def prepare(self, encoding: Encoding) -> None:
        """Read the definitions that a brake needs: the first of them takes a third of a second."""
        for guarded in self._host.guarded if self.stops else ():
            standard_info(guarded.stream.type, encoding)

    def raise_(self, alarm: Alarm, now: int, *guarded: str) -> None:
        """Raise an alarm; brake the streams of these topics until it is settled."""
        self._host.alarms.raise_(alarm, now)
        for topic in guarded if self.stops else ():
            first = not self._braking[topic]
            self._braking[topic].add(alarm)
            for brake in self._of(topic) if first else ():
                brake.hold(alarm.reason)

    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back, and release what only it has braked."""
        self._host.alarms.settle(alarm)
        for topic, alarms in self._braking.items():
            if alarm in alarms:
                alarms.remove(alarm)
                for brake in () if alarms else self._of(topic):
                    brake.let_go()

    def listened(self, topic: str) -> None:
        """Take note that a node has begun to hear what the guard lets go of a stream."""
        for brake in self._of(topic):
            brake.listened()

    def _of(self, topic: str) -> Iterator[Brake]:
        return (brake for name, brake in self._brakes if name == topic)
