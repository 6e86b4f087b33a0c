"""The guard's interface to a middleware: nodes, subscriptions, outputs and a clock.

Messages are bytes as the middleware frames them; a transport does not decode them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from rtron.guard.core.handover_state import HandoverState
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import QoS

if TYPE_CHECKING:
    from rtron.guard.transport.common.memory import Stage

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

    `verified` is true when the middleware's own records confirm the name `node`; a name that a peer
    only claims is not verified.
    """

    node: str
    info: TypeInfo
    latching: bool = False
    verified: bool = True
    qos: QoS | None = None


ConnectHandler = Callable[[Peer], MessageHandler | None]
"""Returns the handler of a new publisher's messages, or None to refuse the publisher."""

LostHandler = Callable[[Peer], None]


def ignore_lost(peer: Peer) -> None:
    """Do nothing about a lost connection."""


MissedHandler = Callable[[Peer, int], None]
"""Called with an accepted publisher and how many of its messages were lost before the next one."""


def ignore_missed(peer: Peer, count: int) -> None:
    """Do nothing about lost messages."""


IsCommand = Callable[[Peer], bool]
"""Returns whether a publisher's messages are commands, which are dropped if late."""


def accept_any_age(peer: Peer) -> bool:
    """Accept all messages, however old they are."""
    del peer
    return False


@dataclass(frozen=True, slots=True, kw_only=True)
class InputOptions:
    """How a subscription treats its publishers and their messages, beside connecting them.

    Of an `is_command` publisher no message is passed on that it sent before the subscription, and
    in ROS 2, which tells the age of messages, none that is late. In ROS 2 anybody can announce
    another name for a publisher: one that was known by one of the names in `publishers`, as its
    owner, keeps that name. `queue_size` bounds the messages that wait for the guard; with
    `keep_all` all of a reliable publisher wait, unless they are commands. `on_missed` is told of
    each loss that is known: on ROS 1 those of latched commands. Where `begin` is not 0, only so
    many bytes of each message are passed on, and the others not copied where the middleware lets
    us. `on_lost` is called when the connection to an accepted publisher has ended.
    """

    is_command: IsCommand = accept_any_age
    publishers: tuple[str, ...] = ()
    queue_size: int = 100
    keep_all: bool = False
    begin: int = 0
    on_missed: MissedHandler = ignore_missed
    on_lost: LostHandler = ignore_lost


DEFAULT_INPUT = InputOptions()


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputOptions:
    """What waits for the subscribers of an output.

    `queue_size` bounds the messages that wait for a slow subscriber; with `keep_all` a reliable one
    loses none while the middleware has room and the guard need not wait. Messages before the first
    of the expected `successors` wait a moment for it, and publishers must have the message type
    that `successors` request.
    """

    queue_size: int = 100
    keep_all: bool = False
    successors: tuple[str, ...] = ()


DEFAULT_OUTPUT = OutputOptions()


Greeting = Callable[[], bytes | None]
"""Returns the message that a new subscriber gets first, None if it gets what is latched."""


@dataclass(frozen=True, slots=True)
class SubscriberProgress:
    """How far a subscriber has come: bytes that it has taken, and whether more wait for it.

    `taken` is None where that is not known at the moment.
    """

    node: str
    address: str
    taken: int | None
    is_awaited: bool


class Output(Protocol):
    """A topic that a node of the guard publishes."""

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is not the known or the requested one."""
        ...

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer subscribers at least the QoS of a flow's publisher, where there is QoS."""
        ...

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer these nodes the QoS that they request, where there is QoS: a stop reaches them."""
        ...

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; latch it for late ones as the last message of `latched_by`."""
        ...

    def greet(self, greeting: Greeting) -> None:
        """Send each new subscriber the message of `greeting` first, and nothing latched.

        In ROS 2 it is sent to all subscribers, as soon as a new one is known.
        """
        ...

    def is_subscribed_by(self, node: str) -> bool:
        """Return whether a node that calls itself `node` subscribes."""
        ...

    def clear_latched(self) -> None:
        """Latch no message for late subscribers any more."""
        ...

    @property
    def lost(self) -> int:
        """How many messages did not reach a subscriber, as far as the middleware tells."""
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
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish `topic` as `node`."""
        ...

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic` as `node`, without messages that this transport publishes."""
        ...

    def link_nodes(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Show two nodes of the guard as connected by `topic`; messages pass inside the guard."""
        ...


class LiveTransport(Transport, Protocol):
    """A transport in a running graph, where other nodes make requests and send what they like."""

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Call `handler` with a node of the guard that others shut down, and why (ROS 1 only)."""
        ...

    def set_unreadable_handler(self, handler: Callable[[str, str, str], None]) -> None:
        """Call `handler` with a topic, a node, and why its message is unreadable (ROS 2 only)."""
        ...

    def succeed(self, handover: HandoverState) -> None:
        """Take over from the guard before, and leave to the next one what it must know (ROS 2)."""
        ...

    @property
    def participant(self) -> bytes:
        """What identifies this process in the graph: the first bytes of its GIDs (ROS 2)."""
        ...

    def set_supervisor(self, participant: Callable[[], bytes]) -> None:
        """Take what tells the supervisor's participant, b"" if not yet: its nodes are ours."""
        ...

    def subscriber_progress(self, topic: str) -> Sequence[SubscriberProgress]:
        """Return how far each subscriber of a topic of ours has come, where that is known.

        rcl does not tell it.
        """
        ...

    def create_stage(self) -> "Stage":
        """Return where messages can be rehearsed as this transport receives and sends them."""
        ...

    def close(self) -> None:
        """Leave the graph."""
        ...


class NumberedMessage(bytes):
    """A message with its DDS sequence number, or its source time where the RMW gives no numbers.

    `writer` identifies the publisher, and not the one that replaces it after a restart. `number`
    grows with each message; one that is sent again keeps its number. `source_time` is when the
    message was first sent, ns of the publisher's wall clock, 0 if unknown.
    """

    writer: str
    number: int
    source_time: int

    @classmethod
    def of(
        cls, message: bytes, writer: str, number: int, source_time: int = 0
    ) -> "NumberedMessage":
        """Return a message with its number."""
        numbered = cls(message)
        numbered.writer, numbered.number, numbered.source_time = writer, number, source_time
        return numbered
