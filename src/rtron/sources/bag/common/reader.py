"""What a bag holds, whatever its format: connections, and messages in the order of time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from rtron.vocabulary import QoS

Encoding: TypeAlias = Literal["ros1", "cdr", "json"]
"""JSON is what an incident's decisions are in; bags of ROS have none."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BagConnection:
    """A stream of messages: a topic, and in ROS 1 one publisher of it (`callerid`).

    `definition` is the text of the message definition, in the format that MCAP calls
    `definition_format` (`ros1msg`, `ros2msg` or `ros2idl`); both are empty where the bag has none.
    `offered_qos` has an entry for each ROS 2 publisher the recorder saw. A connection equals only
    itself, so it is a cheap key.
    """

    topic: str
    type: str
    encoding: Encoding
    md5sum: str = ""
    definition: str = ""
    definition_format: str = ""
    callerid: str = ""
    latching: bool = False
    offered_qos: tuple[QoS, ...] = ()


Message: TypeAlias = tuple[int, BagConnection, bytes]


@dataclass(frozen=True, slots=True, kw_only=True)
class BagReader:
    """A bag that was opened: its connections, and the way to its messages.

    `skipped` are topics whose messages are not ROS messages, and why.
    """

    path: Path
    connections: tuple[BagConnection, ...]
    messages: Callable[[], Iterator[Message]]
    skipped: tuple[tuple[str, str], ...] = ()

    def __iter__(self) -> Iterator[Message]:
        """Yield (time in ns, connection, serialised message) in the order of time.

        Raise InputError where the bag is damaged, after the messages before that.
        """
        return self.messages()


def unknown_encoding(encoding: str) -> str:
    """Return why a topic is left out whose messages are encoded in some other way."""
    return f"its messages are encoded as {encoding[:50]!r}, not as ROS does"
