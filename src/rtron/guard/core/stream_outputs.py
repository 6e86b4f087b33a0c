"""What a guarded stream publishes: to its successors, to tools, and between its own nodes."""

from collections.abc import Callable, Sequence

from rtron.guard.transport.common.protocol import Output, Transport, TypeInfo
from rtron.vocabulary import (
    PRIVATE_ROOT,
    CoordinationKind,
    PolicyName,
    QoS,
    Stream,
    flow_topic,
    names_node,
    output_topic,
)


class Ends:
    """The outputs of one stream; a flow whose publisher also listens gets all but its own words."""

    def __init__(self, stream: Stream, nodes: Sequence[str], transport: Transport) -> None:
        self._stream = stream
        self._nodes = nodes
        self._transport = transport
        self._info: TypeInfo | None = None
        self._latching: set[str] = set()
        self._in_turns = _in_turns(stream)
        self._outputs: list[Output] = []
        self._mirrors: dict[str, Output] = {}
        self._joints: list[Output] = []
        self._learned: Callable[[TypeInfo], None] | None = None
        self._sent: Callable[[str, bytes], None] | None = None

    def report(
        self, learned: Callable[[TypeInfo], None], sent: Callable[[str, bytes], None]
    ) -> None:
        """Tell from now on which type was learned, and each message with its flow."""
        self._learned, self._sent = learned, sent

    def open(self) -> None:
        """Advertise everything."""
        self._open_outputs()
        self._open_mirrors()
        self._open_joints()

    def learn(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is not what is known or asked for."""
        ends = [*self._outputs, *self._mirrors.values(), *self._joints]
        learned = all(end.learn(info) for end in ends)
        if learned and self._learned and info != self._info:
            self._learned(info)
        self._info = info if learned else self._info
        return learned

    def knows(self, info: TypeInfo) -> bool:
        """Tell whether a type is the one that was learned."""
        return self._info is not None and self._info.md5sum == info.md5sum

    def latch(self, flow: str, *, latching: bool) -> None:
        """Keep a flow's last message for late subscribers from now on, or keep none.

        Where flows take turns, the last message of all is kept as soon as one of them latches: an
        older one of another flow is no longer so.
        """
        change = self._latching.add if latching else self._latching.discard
        change(flow)

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer what a flow's publisher offers to all who get its words."""
        for output in (*self._outputs, *self._joints):
            output.offer(flow, qos)
        for name, mirror in self._mirrors.items():
            if name != flow:
                mirror.offer(flow, qos)

    def send(self, flow: str, message: bytes) -> None:
        """Send a message that a flow said, or that is said in its place."""
        latched_by = self._kept_as(flow)
        if self._sent:
            self._sent(flow, message)
        for output in self._outputs:
            output.publish(message, latched_by)
        for name, mirror in self._mirrors.items():
            if name != flow:
                mirror.publish(message, latched_by)
        for joint in self._joints:
            joint.publish(message, latched_by)

    def reaches(self, node: str) -> bool:
        """Tell whether what is sent reaches a node, on its own flow or on the private output."""
        private = (*self._outputs[:1], *self._mirrors.values())
        return any(output.reaches(node) for output in private)

    def forget(self) -> None:
        """Keep nothing for late subscribers any more."""
        for output in (*self._outputs, *self._mirrors.values()):
            output.forget()

    def _kept_as(self, flow: str) -> str | None:
        """Return as whose last word late subscribers get what a flow says; None if as nobody's."""
        if self._in_turns:
            return self._stream.topic if self._latching else None
        return flow if flow in self._latching else None

    def _open_outputs(self) -> None:
        stream = self._stream
        for topic in (output_topic(stream.topic), stream.topic):
            output = self._transport.advertise(
                self._nodes[-1],
                topic,
                stream.type,
                queue_size=stream.queue_size,
                successors=() if topic == stream.topic else stream.successors,
            )
            self._outputs.append(output)

    def _open_mirrors(self) -> None:
        stream = self._stream
        for flow in stream.flows:
            if any(names_node(flow.publisher, node) for node in stream.successors):
                topic = flow_topic(stream.topic, flow.name)
                self._mirrors[flow.name] = self._transport.advertise(
                    self._nodes[-1],
                    topic,
                    stream.type,
                    queue_size=stream.queue_size,
                    successors=(flow.publisher,),
                )

    def _open_joints(self) -> None:
        stages = self._stream.stages
        for before, after, stage in zip(self._nodes, self._nodes[1:], stages, strict=False):
            joint = f"{PRIVATE_ROOT}{self._stream.topic}/{stage.id}"
            self._joints.append(self._transport.join(before, after, joint, self._stream.type))


def _in_turns(stream: Stream) -> bool:
    """Tell whether one flow at a time has the output, so that one word is what is so now."""
    first = stream.stages[0]
    is_grcn = first.coordination is CoordinationKind.GRCN
    return is_grcn and first.settings.policy is not PolicyName.BLOCK
