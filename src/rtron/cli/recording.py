"""A bag's messages as the guard sees them."""

from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.guard.recorded import Recorded
from rtron.messages.encoding import Encoding
from rtron.sources.bag.messages import read_messages
from rtron.sources.bag.reading import BagConnection, BagReading

Message = tuple[int, Recorded, bytes]


def recorded_messages(bag: Path, ros: int) -> Iterator[Message]:
    """Yield (time in ns, what it belongs to, bytes with their prefix) in the order of time.

    InputError if the bag cannot be read, or is of the other ROS.
    """
    reading = read_messages(bag)
    encoding = Encoding.ROS1 if ros == 1 else Encoding.CDR
    known = _known(reading, encoding)
    if reading.connections and not known:
        message = f"the plan is for ROS {ros}, the bag is not"
        raise InputError(
            message, path=str(bag), help="set `ros` in the plan, or choose another bag"
        )
    if encoding is Encoding.CDR:
        yield from ((time, known[on], data) for time, on, data in reading if on in known)
        return
    prefix = encoding.prefix
    for time, on, data in reading:
        if on in known:
            yield time, known[on], prefix(len(data)) + data


def _known(reading: BagReading, encoding: Encoding) -> dict[BagConnection, Recorded]:
    return {on: _recorded(on) for on in reading.connections if on.encoding == encoding.value}


def _recorded(on: BagConnection) -> Recorded:
    readable = on.definition_format != "ros2idl"
    return Recorded(
        topic=on.topic,
        type=on.type,
        md5sum=on.md5sum,
        definition=on.definition if readable else "",
        publisher=on.callerid,
        latching=on.latching,
    )
