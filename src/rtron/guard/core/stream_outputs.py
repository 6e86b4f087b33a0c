"""The topics that a guarded stream publishes: for successors, for tools, between its nodes."""

from collections.abc import Callable, Sequence

from rtron.guard.transport.common.protocol import (
    Greeting,
    Output,
    OutputOptions,
    Transport,
    TypeInfo,
)
from rtron.vocabulary import (
    PRIVATE_ROOT,
    CoordinationKind,
    PolicyName,
    QoS,
    Stream,
    StreamKind,
    flow_topic,
    matches_node,
    output_topic,
)


class StreamOutputs:
    """The outputs of one stream; a flow's publisher that also subscribes gets others' messages."""

    def __init__(self, stream: Stream, nodes: Sequence[str], transport: Transport) -> None:
        self._stream = stream
        self._nodes = nodes
        self._transport = transport
        self._type_info: TypeInfo | None = None
        self._latching_flows: set[str] = set()
        self._takes_turns = _takes_turns(stream)
        self._topics: dict[str, Output] = {}
        self._outputs: list[Output] = []
        self._mirrors: dict[str, Output] = {}
        self._node_links: list[Output] = []
        self._on_type: Callable[[TypeInfo], None] | None = None
        self._on_sent: Callable[[str, bytes], None] | None = None

    def set_listeners(
        self, on_type: Callable[[TypeInfo], None], on_sent: Callable[[str, bytes], None]
    ) -> None:
        """Call `on_type` when the type is learned, and `on_sent` with each message and its flow."""
        self._on_type, self._on_sent = on_type, on_sent

    def open(self) -> None:
        """Advertise everything."""
        self._open_outputs()
        self._open_mirrors()
        self._open_node_links()

    def learn(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is not what is known or asked for."""
        outputs = [*self._outputs, *self._mirrors.values(), *self._node_links]
        is_accepted = all(end.learn_type(info) for end in outputs)
        if is_accepted and self._on_type and info != self._type_info:
            self._on_type(info)
        self._type_info = info if is_accepted else self._type_info
        return is_accepted

    def has_type(self, info: TypeInfo) -> bool:
        """Return whether a type is the one that was learned."""
        return self._type_info is not None and self._type_info.md5sum == info.md5sum

    def set_latching(self, flow: str, *, latching: bool) -> None:
        """Latch a flow's last message for late subscribers from now on, or do not.

        Where flows take turns, the last message of all flows is latched as soon as one of them
        latches: an older one of another flow is out of date.
        """
        change = self._latching_flows.add if latching else self._latching_flows.discard
        change(flow)

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer the QoS of a flow's publisher on all topics that its messages go to."""
        for output in (*self._outputs, *self._node_links):
            output.offer(flow, qos)
        for name, mirror in self._mirrors.items():
            if name != flow:
                mirror.offer(flow, qos)

    def send(self, flow: str, message: bytes) -> None:
        """Send a message of a flow, or one that the guard sends for it."""
        latched_by = self._latch_key(flow)
        if self._on_sent:
            self._on_sent(flow, message)
        for output in self._outputs:
            output.publish(message, latched_by)
        for name, mirror in self._mirrors.items():
            if name != flow:
                mirror.publish(message, latched_by)
        for link in self._node_links:
            link.publish(message, latched_by)

    def reaches(self, node: str) -> bool:
        """Return whether a node subscribes to the private output, or to a mirror for its flow."""
        private = (*self._outputs[:1], *self._mirrors.values())
        return any(output.is_subscribed_by(node) for output in private)

    def greet(self, greeting: Greeting) -> None:
        """Send what `greeting` gives to each new subscriber of the private output first."""
        for output in self._outputs[:1]:
            output.greet(greeting)

    @property
    def lost(self) -> dict[str, int]:
        """How many messages did not reach a subscriber, by the topic where any was lost."""
        return {topic: output.lost for topic, output in self._topics.items() if output.lost}

    def _latch_key(self, flow: str) -> str | None:
        """Return the key under which a flow's message is latched, None if it is not."""
        if self._takes_turns:
            return self._stream.topic if self._latching_flows else None
        return flow if flow in self._latching_flows else None

    def _open_outputs(self) -> None:
        stream = self._stream
        for topic in (output_topic(stream.topic), stream.topic):
            output = self._advertise(topic, () if topic == stream.topic else stream.successors)
            self._outputs.append(output)

    def _open_mirrors(self) -> None:
        stream = self._stream
        for flow in stream.flows:
            if any(matches_node(flow.publisher, node) for node in stream.successors):
                topic = flow_topic(stream.topic, flow.name)
                self._mirrors[flow.name] = self._advertise(topic, (flow.publisher,))

    def _advertise(self, topic: str, successors: tuple[str, ...]) -> Output:
        stream, keep_all = self._stream, keeps_all(self._stream)
        options = OutputOptions(
            queue_size=stream.queue_size, keep_all=keep_all, successors=successors
        )
        output = self._transport.advertise(self._nodes[-1], topic, stream.type, options)
        self._topics[topic] = output
        return output

    def _open_node_links(self) -> None:
        stages = self._stream.stages
        for before, after, stage in zip(self._nodes, self._nodes[1:], stages, strict=False):
            topic = f"{PRIVATE_ROOT}{self._stream.topic}/{stage.id}"
            self._node_links.append(
                self._transport.link_nodes(before, after, topic, self._stream.type)
            )


def keeps_all(stream: Stream) -> bool:
    """Return whether each message of a stream counts: of commands only the newest does."""
    first = stream.stages[0]
    is_grcn = first.coordination_kind is CoordinationKind.GRCN
    return is_grcn and first.settings.kind is not StreamKind.COMMAND


def _takes_turns(stream: Stream) -> bool:
    """Return whether one flow at a time has the output, so that one message is current."""
    first = stream.stages[0]
    is_grcn = first.coordination_kind is CoordinationKind.GRCN
    return is_grcn and first.settings.policy is not PolicyName.BLOCK
