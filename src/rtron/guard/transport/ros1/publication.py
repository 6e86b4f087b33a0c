"""A topic that one of our nodes publishes: its subscribers, and what late ones get."""

from collections.abc import Callable

from rtron.guard.transport.common.backlog import Backlog
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.guard.transport.ros1.subscriber_link import SubscriberLink
from rtron.vocabulary import QoS

_AWAIT_FIRST_NS = 1_000_000_000
_EARLY_BYTES = 1 << 20


class Publication:
    """Sends raw messages to every subscriber, each with a bounded queue of its own.

    The type is learned from the first publisher that the guard approves. A subscriber that comes
    before and names its md5sum is served at once and cut off if the type turns out another; one
    that asks for any type waits until it is known.
    """

    def __init__(
        self,
        node: str,
        topic: str,
        type: str,
        now: Callable[[], int],
        *,
        queue_size: int,
        successors: tuple[str, ...],
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = type
        self.info: TypeInfo | None = None
        self.links: list[SubscriberLink] = []
        self._now = now
        self._limit = queue_size
        self._undecided: list[SubscriberLink] = []
        self._latched: dict[str, bytes] = {}
        self._successors = successors
        self._early = Backlog(queue_size, _EARLY_BYTES) if successors else None
        self._early_since = 0

    def learn(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if another is known or the name differs."""
        if self.info is not None:
            return self.info.md5sum == info.md5sum and self.info.type == info.type
        if (self.type and self.type != info.type) or info.md5sum not in self._asked_for(info):
            return False
        self.info, self.type = info, info.type
        for link in [link for link in self.links if link.md5sum not in ("*", info.md5sum)]:
            link.close()
        undecided, self._undecided = self._undecided, []
        for link in undecided:
            self._welcome(link, info)
        return True

    def offer(self, flow: str, qos: QoS) -> None:
        """Do nothing: ROS 1 has no QoS but latching, which `publish` is told."""

    def suit(self, successors: tuple[str, ...]) -> None:
        """ROS 1 has no QoS."""

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; keep it for late ones as the last word of `latched_by`."""
        if latched_by is not None:
            self._latched.pop(latched_by, None)
            self._latched[latched_by] = message
        for link in self.links:
            link.send(message)
        if self._early is not None and not self.links:
            self._keep(self._early, message)

    def reaches(self, node: str) -> bool:
        """Tell whether a subscriber says that it is `node`."""
        return any(link.node == node for link in self.links)

    def forget(self) -> None:
        """Keep nothing for late subscribers any more."""
        self._latched.clear()
        self._early = None

    def admit(self, link: SubscriberLink, fields: dict[str, str]) -> None:
        """Answer a subscriber's header."""
        link.allow(self._limit)
        link.closed = self._left
        asked = TypeInfo(fields.get("type", "*"), link.md5sum, fields.get("message_definition", ""))
        if self.info is not None:
            self._check(link, asked, self.info)
        elif link.md5sum == "*":
            self._undecided.append(link)
        elif self.type in ("", asked.type):
            self._welcome(link, asked)
        else:
            link.refuse(f"{self.topic} is of type {self.type}, not {asked.type}")

    def close(self) -> None:
        """Close every connection."""
        for link in [*self.links, *self._undecided]:
            link.close()

    def _check(self, link: SubscriberLink, asked: TypeInfo, info: TypeInfo) -> None:
        if asked.md5sum in ("*", info.md5sum):
            self._welcome(link, info)
        else:
            link.refuse(
                f"{self.topic} is of type {info.type} with md5sum {info.md5sum}, "
                f"not {asked.type} with {asked.md5sum}"
            )

    def _welcome(self, link: SubscriberLink, info: TypeInfo) -> None:
        if link.is_closed:
            return
        link.welcome(
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
        for message in [*self._latched.values(), *self._waited()]:
            link.send(message)

    def _keep(self, early: Backlog, message: bytes) -> None:
        """Let the first messages wait for the first subscriber; when it is late, they are stale."""
        now = self._now()
        self._early_since = self._early_since or now
        if now - self._early_since > _AWAIT_FIRST_NS:
            self._early = None
        else:
            early.append(message)

    def _waited(self) -> list[bytes]:
        early, self._early = self._early, None
        if not early or self._now() - self._early_since > _AWAIT_FIRST_NS:
            return []
        latched = set(self._latched.values())
        waited = [early.pop() for _ in range(len(early))]
        return [message for message in waited if message not in latched]

    def _asked_for(self, info: TypeInfo) -> set[str]:
        """Return the md5sums that the successors ask for; any will do while none has said."""
        links = (link for link in self.links if link.node in self._successors)
        return {link.md5sum for link in links} or {info.md5sum}

    def _left(self, link: SubscriberLink) -> None:
        for group in (self.links, self._undecided):
            if link in group:
                group.remove(link)
