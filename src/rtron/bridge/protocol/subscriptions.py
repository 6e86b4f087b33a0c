"""What a client reads of a topic: how often, in which pieces, and what waits for its turn.

Of several subscriptions of one client to one topic the most demanding counts (rosbridge v2.0,
3.3.4): the lowest throttle, the longest queue, the smallest fragments.
"""

from collections import deque
from dataclasses import dataclass

from rtron.bridge.protocol.frames import Document, whole_number
from rtron.bridge.rights.document import SubscribeRight
from rtron.errors import WireError
from rtron.vocabulary import SECOND

_MILLISECOND = SECOND // 1000
COMPRESSIONS = ("none", "png", "cbor")
"""How messages can be sent; of several subscriptions the last of these counts."""
MAX_SUBSCRIPTIONS = 32
"""How many subscriptions one client may have to one topic."""
_MAX_THROTTLE_MS = 3_600_000
_LARGE = 1 << 62


@dataclass(frozen=True, slots=True)
class SubscribeOptions:
    """How one subscription wants its messages: `throttle` in ns, `fragment` in characters."""

    throttle: int = 0
    queue: int = 0
    fragment: int = _LARGE
    compression: str = "none"

    @classmethod
    def of(cls, document: Document, max_queue: int) -> "SubscribeOptions":
        """Return the options of a `subscribe`; WireError if they are none."""
        compression = document.get("compression") or "none"
        if compression not in COMPRESSIONS:
            kind, known = str(compression)[:20], ", ".join(COMPRESSIONS)
            raise WireError(f"there is no compression {kind!r} here: choose from {known}")
        throttle = min(whole_number(document, "throttle_rate"), _MAX_THROTTLE_MS)
        fragment = whole_number(document, "fragment_size")
        return cls(
            throttle=throttle * _MILLISECOND,
            queue=min(whole_number(document, "queue_length"), max_queue),
            fragment=fragment or _LARGE,
            compression=str(compression),
        )


class TopicReader:
    """A topic that a client reads, with its subscriptions by their ids."""

    def __init__(self, right: SubscribeRight) -> None:
        self.right = right
        self.skipped_large = False
        """Whether the client knows that messages of this topic are too large for it."""
        self._subscriptions: dict[object, SubscribeOptions] = {}
        self._waiting: deque[bytes] = deque()
        self._next_at = 0
        self._least_interval = int(SECOND / right.rate)

    def subscribe(self, id: object, options: SubscribeOptions) -> None:
        """Add or change a subscription; WireError if there are too many."""
        if id not in self._subscriptions and len(self._subscriptions) >= MAX_SUBSCRIPTIONS:
            raise WireError(f"{self.right.topic} has {MAX_SUBSCRIPTIONS} subscriptions of yours")
        self._subscriptions[id] = options

    def unsubscribe(self, id: object) -> bool:
        """Remove a subscription, all of them for None; return whether none is left."""
        if id is None:
            self._subscriptions.clear()
        elif id not in self._subscriptions:
            raise WireError(f"you have no subscription {str(id)[:80]!r} to {self.right.topic}")
        else:
            del self._subscriptions[id]
        return not self._subscriptions

    @property
    def options(self) -> SubscribeOptions:
        """What counts of all subscriptions."""
        each = self._subscriptions.values()
        return SubscribeOptions(
            throttle=max(self._least_interval, min(one.throttle for one in each)),
            queue=max(one.queue for one in each),
            fragment=min(one.fragment for one in each),
            compression=max((one.compression for one in each), key=COMPRESSIONS.index),
        )

    @property
    def next_at(self) -> int | None:
        """When a message that waits has its turn, ns; None if none waits."""
        return self._next_at if self._waiting else None

    def take(self, message: bytes, now: int) -> bytes | None:
        """Take a message of the topic; return it if it is to be sent now.

        Otherwise it waits, if there is a queue; the oldest makes room for it.
        """
        options = self.options
        if now >= self._next_at and not self._waiting:
            self._next_at = now + options.throttle
            return message
        if options.queue:
            self._waiting.append(message)
        while len(self._waiting) > options.queue:
            self._waiting.popleft()
        return None

    def take_due(self, now: int) -> bytes | None:
        """Return the message that has waited and has its turn now, if there is one."""
        if not self._waiting or now < self._next_at:
            return None
        self._next_at = now + self.options.throttle
        return self._waiting.popleft()
