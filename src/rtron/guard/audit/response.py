"""What follows from what the audit finds: alarms, and the brakes where the plan says so."""

from collections import defaultdict

from rtron.guard.host import Host
from rtron.guard.types import standard_info
from rtron.messages.encoding import Encoding
from rtron.vocabulary import Alarm, Mode, OnForeign

_BY = "the audit"


class Response:
    """Raises and settles alarms; a stream is braked for as long as one that brakes it stands.

    In a dry run, and where the plan says `on_foreign: alarm`, nothing is braked.
    """

    def __init__(self, host: Host, on_foreign: OnForeign, *, dry_run: bool) -> None:
        self.stops = on_foreign is OnForeign.STOP and not dry_run
        self._host = host
        self._braking: dict[str, set[Alarm]] = defaultdict(set)

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
            if first:
                self._brake(topic, alarm.reason)

    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back, and release what only it has braked."""
        self._host.alarms.settle(alarm)
        for topic, alarms in self._braking.items():
            if alarm in alarms:
                alarms.remove(alarm)
                if not alarms:
                    self._release(topic)

    def _brake(self, topic: str, why: str) -> None:
        for guarded in self._host.guarded:
            if guarded.stream.topic == topic and guarded.stream.mode is Mode.ENFORCE:
                guarded.brake(_BY, why)

    def _release(self, topic: str) -> None:
        for guarded in self._host.guarded:
            if guarded.stream.topic == topic and guarded.stream.mode is Mode.ENFORCE:
                guarded.release(_BY)
