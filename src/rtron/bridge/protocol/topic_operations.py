"""Topics of a client: advertise, publish, subscribe, and the messages that come."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

from rtron.bridge.common.plan_topics import published_topics, subscribed_topics
from rtron.bridge.protocol.cbor import encode_cbor
from rtron.bridge.protocol.client_state import ClientState, TokenBucket, message_bucket
from rtron.bridge.protocol.effects import (
    AdvertiseTopic,
    LeaveTopic,
    PublishBytes,
    ReadTopic,
    SendMessage,
    WithdrawTopic,
)
from rtron.bridge.protocol.frames import (
    Document,
    encode_frame,
    frame_id,
    name_of,
    png_text,
    split_frame,
    text_of,
)
from rtron.bridge.protocol.subscriptions import SubscribeOptions, TopicReader
from rtron.bridge.rights.document import PublishRight, SubscribeRight, same_type
from rtron.errors import WireError
from rtron.messages.common.json_decoder import decode_binary, decode_json

T = TypeVar("T")
_CHANGES, _CHANGES_AT_ONCE = 10.0, 50.0
"""How often a client may change what its node publishes and reads: the ROS graph hears of each."""


class TopicOperations:
    """What one client publishes and reads, as far as its rights go."""

    def __init__(self, state: ClientState) -> None:
        self._state = state
        published = published_topics(state.client, state.ros)
        subscribed = subscribed_topics(state.client, state.ros)
        self._may_publish = {right.topic: right for right in published}
        self._may_read = {right.topic: right for right in subscribed}
        self._rates = {
            right.topic: state.rates.keep(f"publish {right.topic}", message_bucket(right.rate))
            for right in published
        }
        self._advertised: dict[str, str] = {}
        self._readers: dict[str, TopicReader] = {}
        self._sent = 0
        self._changes = state.rates.keep("changes", TokenBucket(_CHANGES, _CHANGES_AT_ONCE))

    def advertise(self, document: Document, now: int, wall_time: int) -> None:
        """Begin to publish a topic."""
        del wall_time
        topic = name_of(document, "topic")
        self._advertise(self._publish_right(topic, text_of(document, "type")), now)
        self._state.tell("info", f"you publish {topic}", frame_id(document))

    def unadvertise(self, document: Document, now: int, wall_time: int) -> None:
        """Publish a topic no more."""
        del now, wall_time
        topic = name_of(document, "topic")
        name = self._advertised.pop(topic, None)
        if name is None:
            self._state.tell("warning", f"you do not publish {topic}", frame_id(document))
        else:
            self._state.effects.append(WithdrawTopic(name))

    def publish(self, document: Document, now: int, wall_time: int) -> None:
        """Publish a message, if it is one of the topic's type and comes not too fast."""
        topic = name_of(document, "topic")
        right = self._publish_right(topic, str(document.get("type") or ""))
        if not self._rates[topic].take(now):
            raise WireError(f"{topic}: more than {right.rate:g} messages a second")
        definition = self._state.types.message(right.type)
        message = self._state.encode(
            definition, document.get("msg", {}), wall_time, frame_id(document)
        )
        if right.approval:
            self._state.check_approval(f"publish {topic}", document.get("msg", {}), now)
        name = self._advertise(right, now)
        latch = document.get("latch") is True
        self._state.effects.append(PublishBytes(name, message, latch))

    def subscribe(self, document: Document, now: int, wall_time: int) -> None:
        """Read a topic; the answer to a topic that the client may not read is a reason."""
        del wall_time
        topic = name_of(document, "topic")
        right = self._read_right(topic, str(document.get("type") or ""))
        options = SubscribeOptions.of(document, self._state.client.limits.queue)
        self._state.types.message(right.type)
        name = self._state.topics.subscribed(self._state.client.node, topic)
        reader = self._readers.get(name)
        if reader is None:
            self._check_change(now)
            reader = self._readers[name] = TopicReader(right)
            self._state.effects.append(ReadTopic(name, right.type))
        reader.subscribe(frame_id(document), options)
        self._state.tell("info", f"you read {topic}", frame_id(document))

    def unsubscribe(self, document: Document, now: int, wall_time: int) -> None:
        """Read a topic no more, or end one subscription to it."""
        del now, wall_time
        topic = name_of(document, "topic")
        name, reader = self._find_reader(topic)
        if reader.unsubscribe(frame_id(document)):
            del self._readers[name]
            self._state.effects.append(LeaveTopic(name))

    def deliver(self, name: str, message: bytes, now: int) -> None:
        """Take a message of a topic of the graph, and send it now, later or not at all."""
        reader = self._readers.get(name)
        due = reader.take(message, now) if reader else None
        if reader and due is not None:
            self._send(reader, due, now)

    def send_due(self, now: int) -> None:
        """Send the messages that have waited long enough."""
        for reader in self._readers.values():
            due = reader.take_due(now)
            if due is not None:
                self._send(reader, due, now)

    @property
    def next_at(self) -> int | None:
        """When the next message that waits is to be sent, ns."""
        times = [each.next_at for each in self._readers.values() if each.next_at is not None]
        return min(times, default=None)

    def _check_change(self, now: int) -> None:
        if not self._changes.take(now):
            raise WireError(f"more than {_CHANGES:g} new topics a second")

    def _advertise(self, right: PublishRight, now: int) -> str:
        """Return the topic of the graph, which is advertised if it was not."""
        if right.topic not in self._advertised:
            self._state.types.message(right.type)
            node = self._state.client.node
            name = self._state.topics.published(node, right.topic, right.type)
            self._check_change(now)
            self._advertised[right.topic] = name
            listeners = self._state.topics.listeners(name)
            self._state.effects.append(AdvertiseTopic(name, right.type, listeners))
        return self._advertised[right.topic]

    def _publish_right(self, topic: str, type: str) -> PublishRight:
        return _right(self._may_publish, topic, type, f"{self._state.client.name} may not publish")

    def _read_right(self, topic: str, type: str) -> SubscribeRight:
        return _right(self._may_read, topic, type, f"{self._state.client.name} may not read")

    def _find_reader(self, topic: str) -> tuple[str, TopicReader]:
        for name, reader in self._readers.items():
            if reader.right.topic == topic:
                return name, reader
        raise WireError(f"you do not read {topic[:80]}")

    def _send(self, reader: TopicReader, message: bytes, now: int) -> None:
        """Send a message, if the client takes messages of its size."""
        limit = self._state.client.limits.message
        if len(message) > limit:
            if not reader.skipped_large:
                reader.skipped_large = True
                reason = f"{reader.right.topic}: a message of {len(message)} bytes is left out"
                self._state.refuse(f"{reason}, you take at most {limit}", now)
            return
        self._sent += 1
        self._state.effects.append(SendMessage(tuple(self._frames(reader, message))))

    def _frames(self, reader: TopicReader, message: bytes) -> "Iterable[str | bytes]":
        """Return a message in the frames that the client has asked for."""
        options, encoding = reader.options, self._state.types.encoding
        definition = self._state.types.message(reader.right.type)
        frame: Document = {"op": "publish", "topic": reader.right.topic}
        if options.compression == "cbor":
            return [encode_cbor(frame | {"msg": decode_binary(definition, encoding, message)})]
        text = encode_frame(frame | {"msg": decode_json(definition, encoding, message)})
        if options.compression == "png":
            text = encode_frame({"op": "png", "data": png_text(text)})
        return split_frame(text, options.fragment, f"{reader.right.topic}:{self._sent}")


def _right(rights: Mapping[str, T], topic: str, type: str, refusal: str) -> T:
    """Return the right to a topic; WireError if there is none, or the type is another."""
    right = rights.get(topic)
    if right is None:
        raise WireError(f"{refusal} {topic[:80]}")
    own = str(getattr(right, "type"))  # noqa: B009 - both rights have one
    if type and not same_type(own, type):
        raise WireError(f"{topic} is of type {own}, not {type[:80]}")
    return right
