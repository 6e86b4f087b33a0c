"""A middleware in memory, for tests, replays and rehearsals."""

import heapq
from collections import defaultdict
from collections.abc import Callable
from itertools import count

from rtron.guard.transport.common.protocol import (
    DEFAULT_OUTPUT,
    ConnectHandler,
    Greeting,
    InputOptions,
    LostHandler,
    MessageHandler,
    Output,
    OutputOptions,
    Peer,
    TypeInfo,
)
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import QoS, normalise_type


class MemoryTransport:
    """Topics as lists; outside nodes publish with `publisher` and subscribe with `listen`.

    Only `advance` moves its clock. Every topic reaches every node that is not `unreachable`.
    """

    def __init__(self, encoding: Encoding = Encoding.ROS1) -> None:
        self.encoding = encoding
        self._time = 0
        self._sequence = count()
        self._timers: list[tuple[int, int, Callable[[], None]]] = []
        self._subscribers: dict[str, list[tuple[ConnectHandler, InputOptions]]] = defaultdict(list)
        self._lost_handlers: dict[tuple[str, Peer], list[LostHandler]] = defaultdict(list)
        self._listeners: dict[str, list[list[bytes]]] = defaultdict(list)
        self.outputs: dict[str, MemoryOutput] = {}
        self.unreachable: set[str] = set()

    def now(self) -> int:
        """Return the time of the memory's clock, ns."""
        return self._time

    def call_at(self, when: int, callback: Callable[[], None]) -> None:
        """Call back once when `advance` reaches `when` (ns)."""
        heapq.heappush(self._timers, (when, next(self._sequence), callback))

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
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish `topic` as `node`; messages never wait here, so no option has an effect."""
        del node, options
        listeners = self._listeners[topic]
        self.outputs[topic] = MemoryOutput(
            type, listeners, lambda node: node not in self.unreachable
        )
        return self.outputs[topic]

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic`; outside publishers that come later are offered to `on_connect`."""
        del node, type
        self._subscribers[topic].append((on_connect, options))

    def link_nodes(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Connect two nodes of the guard; `listen` shows the messages between them."""
        del subscriber
        return self.advertise(publisher, topic, type)

    def publisher(self, topic: str, peer: Peer) -> MessageHandler:
        """Connect an outside publisher and return the function that it publishes with."""
        receivers = []
        for on_connect, options in self._subscribers[topic]:
            receive = on_connect(peer)
            if receive is not None:
                receivers.append(receive)
                self._lost_handlers[topic, peer].append(options.on_lost)

        def publish(message: bytes) -> None:
            for receive in receivers:
                receive(message)

        return publish

    def miss(self, topic: str, peer: Peer, count: int) -> None:
        """Lose messages of an outside publisher."""
        for _, options in self._subscribers[topic]:
            options.on_missed(peer, count)

    def leave(self, topic: str, peer: Peer) -> None:
        """End an outside publisher's connections."""
        for on_lost in self._lost_handlers.pop((topic, peer), []):
            on_lost(peer)

    def listen(self, topic: str) -> list[bytes]:
        """Return a list that fills with what the guard publishes on `topic`, latched first."""
        messages = self.outputs[topic].first_messages() if topic in self.outputs else []
        self._listeners[topic].append(messages)
        return messages


class MemoryOutput:
    """A topic of the guard: every listener's list gets every message."""

    def __init__(
        self, type: str, listeners: list[list[bytes]], is_subscribed_by: Callable[[str], bool]
    ) -> None:
        self.type = normalise_type(type)
        self.is_subscribed_by = is_subscribed_by
        self.info: TypeInfo | None = None
        self.lost = 0
        self.latched: dict[str, bytes] = {}
        self.offered_qos: dict[str, QoS] = {}
        self._listeners = listeners
        self._greeting: Greeting = lambda: None

    def first_messages(self) -> list[bytes]:
        """Return what a new listener hears first: the greeting, or what is latched."""
        greeting = self._greeting()
        return list(self.latched.values()) if greeting is None else [greeting]

    def greet(self, greeting: Greeting) -> None:
        """Take what new listeners hear first."""
        self._greeting = greeting

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the first type that fits; False for any other."""
        if self.info is None and self.type in ("", info.type):
            self.info = info
        return self.info == info

    def offer(self, flow: str, qos: QoS) -> None:
        """Remember the QoS that a flow's publisher offers."""
        self.offered_qos[flow] = qos

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Do nothing: there is no QoS here."""

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Give the message to every listener; latch it for late ones."""
        if latched_by is not None:
            self.latched.pop(latched_by, None)
            self.latched[latched_by] = message
        for messages in self._listeners:
            messages.append(message)

    def clear_latched(self) -> None:
        """Latch no message for late listeners any more."""
        self.latched.clear()


class Stage(MemoryTransport):
    """Takes a message through the parts of its way: it arrives, is handled, and leaves.

    This one has no sockets: what is handled goes to outputs in memory that nobody listens to.
    """

    def __init__(self, encoding: Encoding, now: Callable[[], int]) -> None:
        super().__init__(encoding)
        self._now = now
        self._message = b""

    def now(self) -> int:
        """Return the time of the guard's clock, ns."""
        return self._now()

    def call_at(self, when: int, callback: Callable[[], None]) -> None:
        """Do nothing: what a deadline brings is no part of a message's way."""

    def arrive(self, message: bytes) -> None:
        """Let a message arrive, unless one waits to be handled."""
        self._message = self._message or message

    def handle(self, receive: MessageHandler) -> None:
        """Let `receive` take the message that has arrived."""
        message, self._message = self._message, b""
        if message:
            receive(message)

    def take_output(self) -> None:
        """Take what was sent."""

    def close(self) -> None:
        """Close what the stage has opened."""
