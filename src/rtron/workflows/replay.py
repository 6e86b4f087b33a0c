"""Play a bag through a plan: what the guard would have done."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.guard.replay.player import Message, RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.messages.common.encoding import Encoding
from rtron.planning.plan_file.loader import read_plan
from rtron.sources.bag.common.reader import BagConnection, BagReader
from rtron.sources.bag.formats import open_bag
from rtron.vocabulary import MeasuredRun, Plan, ReplayReport


def replay_bag(bag: Path, plan: Path, on_message: Callable[[int], None]) -> ReplayReport:
    """Return what the policies of a plan decide on the messages of a bag.

    `on_message` is called with the number of messages played. Raise InputError if one of the files
    cannot be read, or if the bag is of another ROS than the plan.
    """
    recording = GuardRecording(bag)
    guard_plan = read_plan(plan, recording.definitions)
    return RecordingPlayer(guard_plan).play(recording.messages(guard_plan.ros), on_message)


def measure_bag(
    bag: Path, plan: Path, on_message: Callable[[int], None]
) -> tuple[Plan, MeasuredRun, tuple[str, ...]]:
    """Return the plan, what a dry run of the guard would have measured, and notes on the bag.

    Callbacks and errors are those of `replay_bag`.
    """
    recording = GuardRecording(bag)
    guard_plan = read_plan(plan, recording.definitions)
    player = RecordingPlayer(guard_plan, measured=True)
    report = player.play(recording.messages(guard_plan.ros), on_message)
    return guard_plan, player.figures(), report.notes


class GuardRecording:
    """An open bag; InputError if it cannot be read, also while its messages are."""

    def __init__(self, bag: Path) -> None:
        self._reading = open_bag(bag)

    @property
    def definitions(self) -> Mapping[str, str]:
        """The definitions that the bag has of its types, where RTron can read them."""
        readable = ((on.type, _definition(on)) for on in self._reading.connections)
        return {type: text for type, text in readable if text}

    def messages(self, ros: int) -> Iterator[Message]:
        """Yield (time in ns, what it belongs to, bytes with their prefix) in the order of time.

        InputError if the bag is of the other ROS.
        """
        reading = self._reading
        encoding = Encoding.ROS1 if ros == 1 else Encoding.CDR
        known = _recorded_connections(reading, encoding)
        if reading.connections and not known:
            message = f"the plan is for ROS {ros}, the bag is not"
            help = "set `ros` in the plan, or choose another bag"
            raise InputError(message, path=str(reading.path), help=help)
        if encoding is Encoding.CDR:
            yield from ((time, known[on], data) for time, on, data in reading if on in known)
            return
        prefix = encoding.prefix
        for time, on, data in reading:
            if on in known:
                yield time, known[on], prefix(len(data)) + data


def _recorded_connections(
    reading: BagReader, encoding: Encoding
) -> dict[BagConnection, RecordedStream]:
    return {
        on: _recorded_connection(on) for on in reading.connections if on.encoding == encoding.value
    }


def _definition(on: BagConnection) -> str:
    return on.definition if on.definition_format != "ros2idl" else ""


def _recorded_connection(on: BagConnection) -> RecordedStream:
    return RecordedStream(
        topic=on.topic,
        type=on.type,
        md5sum=on.md5sum,
        definition=_definition(on),
        publisher=on.callerid,
        latching=on.latching,
    )
