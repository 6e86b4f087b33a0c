"""What the audit and the process of the brakes need of each other: calls here, or messages.

The audit finds intruders; the process of the brakes stops the streams and listens to the intruders
itself, since it answers each of their messages at once.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from rtron.vocabulary import Alarm

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


@dataclass(frozen=True, slots=True)
class ListenToPublisher:
    """Listen to the publisher at an address, which goes past the guard of a stream (ROS 1)."""

    stream: str
    topic: str
    uri: str

    @property
    def subject(self) -> tuple[str, ...]:
        """What a later request of the same kind replaces."""
        return (self.topic, self.uri)


@dataclass(frozen=True, slots=True)
class EndpointTrust:
    """Whose messages on the private outputs are no intruder's (ROS 2).

    `trusted` are participants. `dismissed` are the GIDs of intruders that were taken for gone.
    """

    trusted: frozenset[bytes] = frozenset()
    dismissed: frozenset[bytes] = frozenset()

    @property
    def subject(self) -> tuple[str, ...]:
        """What a later request of the same kind replaces."""
        return ()


ListenRequest = ListenToPublisher | EndpointTrust


class AuditResponse(ABC):
    """What an audit does about what it finds; the audit sets how it is asked."""

    stops_streams: bool
    """Whether an intruder stops a stream at all."""

    def __init__(self) -> None:
        self.dismiss: Callable[[str, bool], str] = lambda topic, is_audible: ""
        """Takes the silent intruders of a stream for gone; returns why not.

        The flag tells whether the guard would have heard them.
        """
        self.on_return: Callable[[bytes], None] = lambda gid: None
        """Takes the GID of an intruder that was taken for gone and speaks."""
        self.find_missing: Callable[[], str] = lambda: "it has not begun"
        """Returns what the audit has not looked at yet, "" when it has looked at everything."""
        self.find_unseen: Callable[[int], Mapping[str, str]] = lambda since: {}
        """Returns the streams after which it has not looked since a time (ns), and why not."""

    @abstractmethod
    def raise_(self, alarm: Alarm, now: int, *guarded: str) -> None:
        """Raise an alarm; stop the streams of these topics until a person clears them."""

    @abstractmethod
    def settle(self, alarm: Alarm) -> None:
        """Take an alarm back: its cause is gone. What it has stopped stays stopped."""

    @abstractmethod
    def withdraw(self, alarm: Alarm) -> None:
        """Take an alarm back that was mistaken, and release what only mistakes have stopped."""

    @property
    @abstractmethod
    def stopped_streams(self) -> frozenset[str]:
        """The streams that intruders have stopped and nobody has cleared."""

    @abstractmethod
    def listen(self, request: ListenRequest) -> None:
        """Listen to intruders as the audit asks, and answer them."""

    @abstractmethod
    def on_new_listener(self, topic: str) -> None:
        """Take note that a node has begun to hear what the guard lets go of a stream."""


class IntruderListener(Protocol):
    """Listens to the intruders of the streams that are stopped, and answers them."""

    def follow(self, request: ListenRequest) -> None:
        """Listen as the audit asks."""
        ...

    def update(self) -> None:
        """Listen where streams are stopped now, and nowhere else."""
        ...

    def silence(self, stream: str) -> int | None:
        """Return for how long (ns) no intruder was heard on a stream; None if none can be."""
        ...
