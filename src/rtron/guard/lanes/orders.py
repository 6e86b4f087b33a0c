"""What the command process lets the bulk process do to its streams."""

from collections.abc import Mapping

from rtron.guard.audit.common.audit_brake import Brake
from rtron.guard.lanes.bulk_connection import BulkConnection
from rtron.guard.lanes.messages import HoldStream, ReleaseStream, RepeatStop, StoppedStreams


class RemoteBrake:
    """The brake of a stream in the bulk process; a new one is told, too. See `Brake`."""

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
        self._connection.send(HoldStream(self._topic, why))

    def release(self) -> None:
        """Let pass again what the policies let pass."""
        self._why = ""
        self._connection.send(ReleaseStream(self._topic))

    def answer(self, message: bytes) -> None:
        """Do nothing."""

    def repeat_stop(self) -> None:
        """Tell the stop to a node that has just begun to listen."""
        self._connection.send(RepeatStop(self._topic))

    def _hold_again(self) -> None:
        if self._why:
            self.hold(self._why)


class Orders:
    """Does in the bulk process what the response to the audit's alarms asks for."""

    def __init__(self, brakes: Mapping[str, Brake]) -> None:
        """`brakes` are by the streams' public names.

        A guard that connects after another tells what is stopped: what is not, it never held.
        """
        self._brakes = brakes
        self._held: set[str] = set()

    def obey(self, message: object) -> None:
        """Do what one message says."""
        match message:
            case HoldStream(topic, reason) if topic in self._brakes:
                self._held.add(topic)
                self._brakes[topic].hold(reason)
            case ReleaseStream(topic) if topic in self._brakes:
                self._release(topic)
            case StoppedStreams(topics):
                for topic in self._held - topics:
                    self._release(topic)
            case RepeatStop(topic) if topic in self._brakes:
                self._brakes[topic].repeat_stop()

    def _release(self, topic: str) -> None:
        """Release a stream, also when only the list of those that are stopped lacks it."""
        self._held.discard(topic)
        self._brakes[topic].release()
