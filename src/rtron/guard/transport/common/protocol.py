"""What the guard needs of a middleware: nodes, inputs, outputs and a clock.

Messages are bytes as the middleware frames them; nothing here looks inside.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import QoS

MessageHandler = Callable[[bytes], object]
"""Takes one message."""


@dataclass(frozen=True, slots=True)
class TypeInfo:
    """A message type as its publisher describes it."""

    type: str
    md5sum: str
    definition: str = ""


@dataclass(frozen=True, slots=True)
class Peer:
    """The publisher at the other end of a connection; `qos` is what it offers in ROS 2.

    `verified` is true when the middleware's own record confirms that `node` lives there; a name
    that a peer only claims is not verified.
    """

    node: str
    info: TypeInfo
    latching: bool = False
    verified: bool = True
    qos: QoS | None = None


ConnectHandler = Callable[[Peer], MessageHandler | None]
"""Says what takes the messages of a publisher that connected, or None to refuse it."""

LostHandler = Callable[[Peer], None]
"""Told that the connection to a publisher that was accepted has ended."""


def ignore_lost(peer: Peer) -> None:
    """Do nothing about a lost connection."""


IsCommand = Callable[[Peer], bool]
"""Says whether a publisher's messages are for the moment: what is late is not to be heard."""


def accept_any_age(peer: Peer) -> bool:
    """Hear all messages, however old they are."""
    del peer
    return False


class Output(Protocol):
    """A topic that a node of the guard publishes."""

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is not what is known or asked for."""
        ...

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer subscribers at least what the publisher of a flow offers, where there is QoS."""
        ...

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer these nodes all that they ask for, where there is QoS: a stop must reach them."""
        ...

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; keep it for late ones as the last word of `latched_by`."""
        ...

    def is_subscribed_by(self, node: str) -> bool:
        """Tell whether a node that says that it is `node` listens."""
        ...

    def clear_latched(self) -> None:
        """Keep nothing for late subscribers any more."""
        ...


class Transport(Protocol):
    """A middleware, seen from the guard; `encoding` is that of its messages."""

    encoding: Encoding

    def now(self) -> int:
        """Return the time of a steady clock, ns."""
        ...

    def call_at(self, when: int, callback: Callable[[], None]) -> None:
        """Call back once at `when` (ns)."""
        ...

    def advertise(
        self,
        node: str,
        topic: str,
        type: str,
        *,
        queue_size: int = 100,
        successors: tuple[str, ...] = (),
    ) -> Output:
        """Publish `topic` as `node`.

        `queue_size` bounds what waits for a slow subscriber. For the `successors` that are
        expected, what is said before the first one comes waits a moment, and the message type
        that they ask for is the one that publishers must have.
        """
        ...

    def subscribe(
        self,
        node: str,
        topic: str,
        type: str,
        on_connect: ConnectHandler,
        on_lost: LostHandler = ignore_lost,
        *,
        is_command: IsCommand = accept_any_age,
        publishers: tuple[str, ...] = (),
    ) -> None:
        """Subscribe `topic` as `node`; never hears what this transport publishes.

        Where the middleware tells messages' age (ROS 2), what is `is_command` is heard only if it
        comes in time; what its publisher has kept, always. Where anybody can tell another name of
        a publisher (ROS 2), who has been known by one of the `publishers` that is its own keeps it.
        """
        ...

    def link_nodes(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Show two nodes of the guard as connected by `topic`; what passes goes inside."""
        ...


class NumberedMessage(bytes):
    """A message with its publisher's number of it.

    `writer` names the publisher and no other, not even the one in its place after a restart;
    `number` grows with each of its messages, and one that it sends again has the number it had.
    `source_time` is when it was said first, ns of its publisher's wall clock, 0 if nobody knows.
    """

    writer: str
    number: int
    source_time: int

    @classmethod
    def of(
        cls, message: bytes, writer: str, number: int, source_time: int = 0
    ) -> "NumberedMessage":
        """Return a message that knows its number."""
        numbered = cls(message)
        numbered.writer, numbered.number, numbered.source_time = writer, number, source_time
        return numbered
