"""A topic that one of our nodes publishes: its subscribers and its latched messages."""

from collections.abc import Callable

from rtron.guard.transport.common.backlog import Backlog
from rtron.guard.transport.common.protocol import Greeting, OutputOptions, TypeInfo
from rtron.guard.transport.ros1.subscriber_link import SubscriberLink
from rtron.vocabulary import QoS

_EARLY_TIMEOUT_NS = 1_000_000_000
_EARLY_BYTES = 1 << 20


class Publication:
    """Sends raw messages to every subscriber, each with a bounded queue of its own.

    The type is learned from the first publisher that the guard approves. A subscriber that comes
    before and names an md5sum is accepted at once, and closed if the type turns out to be another;
    one that requests any type waits until it is known.
    """

    def __init__(
        self, node: str, topic: str, type: str, now: Callable[[], int], options: OutputOptions
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = type
        self.info: TypeInfo | None = None
        self.links: list[SubscriberLink] = []
        self._now = now
        self._queue_size, self._successors = options.queue_size, options.successors
        self._undecided: list[SubscriberLink] = []
        self._latched: dict[str, bytes] = {}
        early = Backlog(options.queue_size, _EARLY_BYTES)
        self._early_messages = early if options.successors else None
        self._early_since = 0
        self._lost = 0
        self._greeting: Greeting = lambda: None
        self.on_subscriber_lost: Callable[[str], None] = lambda node: None

    @property
    def lost(self) -> int:
        """How many messages a subscriber was too slow for, or had not taken when it left."""
        return self._lost + sum(link.dropped for link in self.links)

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if another is known or the name differs."""
        if self.info is not None:
            return self.info.md5sum == info.md5sum and self.info.type == info.type
        if (self.type and self.type != info.type) or info.md5sum not in self._requested_md5sums(
            info
        ):
            return False
        self.info, self.type = info, info.type
        for link in [link for link in self.links if link.md5sum not in ("*", info.md5sum)]:
            link.close()
        undecided, self._undecided = self._undecided, []
        for link in undecided:
            self._accept(link, info)
        return True

    def offer(self, flow: str, qos: QoS) -> None:
        """Do nothing: ROS 1 has no QoS but latching, which is an argument of `publish`."""

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Do nothing: ROS 1 has no QoS."""

    def greet(self, greeting: Greeting) -> None:
        """Send each new subscriber the message of `greeting` first, and nothing latched."""
        self._greeting = greeting

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; latch it for late ones as the last message of `latched_by`."""
        if latched_by is not None:
            self._latched.pop(latched_by, None)
            self._latched[latched_by] = message
        for link in self.links:
            link.send(message)
        if self._early_messages is not None and not self.links:
            self._queue_early(self._early_messages, message)

    def is_subscribed_by(self, node: str) -> bool:
        """Return whether a subscriber calls itself `node`."""
        return any(link.node == node for link in self.links)

    def clear_latched(self) -> None:
        """Latch no message for late subscribers any more."""
        self._latched.clear()
        self._early_messages = None

    def add_subscriber(self, link: SubscriberLink, fields: dict[str, str]) -> None:
        """Answer a subscriber's header."""
        link.set_queue_size(self._queue_size)
        link.on_close = self._on_close
        requested = TypeInfo(
            fields.get("type", "*"), link.md5sum, fields.get("message_definition", "")
        )
        if self.info is not None:
            self._accept_matching(link, requested, self.info)
        elif link.md5sum == "*":
            self._undecided.append(link)
        elif self.type in ("", requested.type):
            self._accept(link, requested)
        else:
            link.refuse(f"{self.topic} is of type {self.type}, not {requested.type}")

    def close(self) -> None:
        """Close every connection."""
        for link in [*self.links, *self._undecided]:
            link.close()

    def _accept_matching(self, link: SubscriberLink, requested: TypeInfo, info: TypeInfo) -> None:
        if requested.md5sum in ("*", info.md5sum):
            self._accept(link, info)
        else:
            link.refuse(
                f"{self.topic} is of type {info.type} with md5sum {info.md5sum}, "
                f"not {requested.type} with {requested.md5sum}"
            )

    def _accept(self, link: SubscriberLink, info: TypeInfo) -> None:
        if link.is_closed:
            return
        link.accept(
            {
                "callerid": self.node,
                "topic": self.topic,
                "type": info.type,
                "md5sum": info.md5sum,
                "message_definition": info.definition,
                "latching": "1" if self._latched else "0",
            }
        )
        if link.is_closed:
            return
        self.links.append(link)
        for message in self._first_messages():
            link.send(message)

    def _first_messages(self) -> list[bytes]:
        """Return what a new subscriber gets first: the greeting, or what is latched or early."""
        greeting, early = self._greeting(), self._take_early()
        return [*self._latched.values(), *early] if greeting is None else [greeting]

    def _queue_early(self, early: Backlog, message: bytes) -> None:
        """Let the first messages wait for the first subscriber; after 1 s they are stale."""
        now = self._now()
        self._early_since = self._early_since or now
        if now - self._early_since > _EARLY_TIMEOUT_NS:
            self._early_messages = None
        else:
            early.append(message)

    def _take_early(self) -> list[bytes]:
        early, self._early_messages = self._early_messages, None
        if not early or self._now() - self._early_since > _EARLY_TIMEOUT_NS:
            return []
        self._lost += early.dropped
        latched = set(self._latched.values())
        messages = [early.pop() for _ in range(len(early))]
        return [message for message in messages if message not in latched]

    def _requested_md5sums(self, info: TypeInfo) -> set[str]:
        """Return the md5sums that the successors request; that of `info` while there is none."""
        links = (link for link in self.links if link.node in self._successors)
        return {link.md5sum for link in links} or {info.md5sum}

    def _on_close(self, link: SubscriberLink) -> None:
        for group in (self.links, self._undecided):
            if link in group:
                group.remove(link)
                self._lost += link.dropped
                self.on_subscriber_lost(link.node)
