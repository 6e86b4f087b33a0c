"""A bag's messages as the guard sees them."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.messages.common.encoding import Encoding
from rtron.sources.bag.common.reader import BagConnection, BagReader
from rtron.sources.bag.formats import open_bag

Message = tuple[int, RecordedStream, bytes]


class GuardRecording:
    """A bag that was opened; InputError if it cannot be read, also while its messages are."""

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
