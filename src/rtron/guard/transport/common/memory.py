"""A middleware in memory: the guard as it is, with a clock that only `advance` moves."""

import heapq
from collections import defaultdict
from collections.abc import Callable
from itertools import count

from rtron.guard.transport.common.protocol import (
    Connect,
    Lost,
    Momentary,
    Output,
    Peer,
    Receive,
    TypeInfo,
    ignore,
    never,
)
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import QoS, normalise_type


class MemoryTransport:
    """Topics as lists; outside nodes speak with `publisher` and listen with `listen`.

    Every topic reaches every node that is not `deaf`.
    """

    def __init__(self, encoding: Encoding = Encoding.ROS1) -> None:
        self.encoding = encoding
        self._time = 0
        self._order = count()
        self._timers: list[tuple[int, int, Callable[[], None]]] = []
        self._connects: dict[str, list[tuple[Connect, Lost]]] = defaultdict(list)
        self._links: dict[tuple[str, Peer], list[Lost]] = defaultdict(list)
        self._heard: dict[str, list[list[bytes]]] = defaultdict(list)
        self.outputs: dict[str, MemoryOutput] = {}
        self.deaf: set[str] = set()

    def now(self) -> int:
        """Return the time of the memory's clock, ns."""
        return self._time

    def call_at(self, when: int, callback: Callable[[], None]) -> None:
        """Call back once when `advance` reaches `when` (ns)."""
        heapq.heappush(self._timers, (when, next(self._order), callback))

    def advance(self, duration: int) -> None:
        """Let `duration` (ns) pass, timers included, in order."""
        end = self._time + duration
        while self._timers and self._timers[0][0] <= end:
            when, _, callback = heapq.heappop(self._timers)
            self._time = max(self._time, when)
            callback()
        self._time = end

    def jump(self, duration: int) -> None:
        """Let `duration` (ns) pass at once: what was due meanwhile is called once, at the end."""
        self._time += duration
        for _ in range(sum(when <= self._time for when, _, _ in self._timers)):
            heapq.heappop(self._timers)[-1]()

    def advertise(
        self,
        node: str,
        topic: str,
        type: str,
        *,
        queue_size: int = 100,
        successors: tuple[str, ...] = (),
    ) -> Output:
        """Publish `topic` as `node`; nothing waits here, so `queue_size` bounds nothing."""
        del node, queue_size, successors
        heard = self._heard[topic]
        self.outputs[topic] = MemoryOutput(type, heard, lambda node: node not in self.deaf)
        return self.outputs[topic]

    def subscribe(
        self,
        node: str,
        topic: str,
        type: str,
        connect: Connect,
        lost: Lost = ignore,
        *,
        momentary: Momentary = never,
        publishers: tuple[str, ...] = (),
    ) -> None:
        """Subscribe `topic`; outside publishers that come later are offered to `connect`."""
        del node, type, momentary, publishers
        self._connects[topic].append((connect, lost))

    def join(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Connect two nodes of the guard; what passes can be listened to."""
        del subscriber
        return self.advertise(publisher, topic, type)

    def publisher(self, topic: str, peer: Peer) -> Receive:
        """Connect an outside publisher and return what it speaks into."""
        receivers = []
        for connect, lost in self._connects[topic]:
            receive = connect(peer)
            if receive is not None:
                receivers.append(receive)
                self._links[topic, peer].append(lost)

        def say(message: bytes) -> None:
            for receive in receivers:
                receive(message)

        return say

    def leave(self, topic: str, peer: Peer) -> None:
        """Let an outside publisher's connections end."""
        for lost in self._links.pop((topic, peer), []):
            lost(peer)

    def listen(self, topic: str) -> list[bytes]:
        """Return a list that fills with what the guard publishes on `topic`, latched first."""
        heard = list(self.outputs[topic].latched.values()) if topic in self.outputs else []
        self._heard[topic].append(heard)
        return heard


class MemoryOutput:
    """A topic of the guard: every listener's list gets every message."""

    def __init__(
        self, type: str, listeners: list[list[bytes]], reaches: Callable[[str], bool]
    ) -> None:
        self.type = normalise_type(type)
        self.reaches = reaches
        self.info: TypeInfo | None = None
        self.latched: dict[str, bytes] = {}
        self.offered: dict[str, QoS] = {}
        self._listeners = listeners

    def learn(self, info: TypeInfo) -> bool:
        """Take the first type that fits; False for any other."""
        if self.info is None and self.type in ("", info.type):
            self.info = info
        return self.info == info

    def offer(self, flow: str, qos: QoS) -> None:
        """Know what the publisher of a flow offers."""
        self.offered[flow] = qos

    def suit(self, successors: tuple[str, ...]) -> None:
        """Everybody here hears everything."""

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Hand the message to every listener; keep it for late ones."""
        if latched_by is not None:
            self.latched.pop(latched_by, None)
            self.latched[latched_by] = message
        for heard in self._listeners:
            heard.append(message)

    def forget(self) -> None:
        """Keep nothing for late listeners any more."""
        self.latched.clear()
