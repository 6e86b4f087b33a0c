"""The topics of a guarded action beside its goals: to clients one node is the server, on all five.

Clients compare who subscribes their goals with who tells the status (actionlib's
`wait_for_server`), so all that faces them belongs to the first coordination node.
"""

from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.core.message_types import standard_info
from rtron.guard.transport.common.protocol import (
    DEFAULT_INPUT,
    InputOptions,
    MessageHandler,
    Output,
    OutputOptions,
    Peer,
    Transport,
    TypeInfo,
)
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    ROS1_SERVER_TOPICS,
    SERVER_FLOW,
    UNAPPROVED,
    Ros1ActionTopic,
    Stream,
    flow_topic,
    matches_node,
    output_topic,
    ros1_topic_name,
)

if TYPE_CHECKING:
    from rtron.guard.action.ros1.stream import Ros1ActionStream

CANCEL = "actionlib_msgs/GoalID"
STATUS = "actionlib_msgs/GoalStatusArray"


class ActionTopics:
    """The cancels, statuses, feedback and results of one action."""

    def __init__(
        self, stream: Stream, node: str, transport: Transport, listener: "Ros1ActionStream"
    ) -> None:
        self._stream = stream
        self._node = node
        self._transport = transport
        self._listener = listener
        self._cancel_outputs: list[Output] = []
        self._server_outputs: dict[Ros1ActionTopic, list[Output]] = {}

    def open(self) -> None:
        """Join the graph."""
        self._open_cancel_topics()
        for part in ROS1_SERVER_TOPICS:
            self._open_server_topics(part)

    def publish_cancel(self, message: bytes) -> None:
        """Send a cancel to the server."""
        for output in self._cancel_outputs:
            output.publish(message)

    def publish(self, part: Ros1ActionTopic, message: bytes) -> None:
        """Send to the clients what the server said, or what is said in its place."""
        latched_by = SERVER_FLOW if part is Ros1ActionTopic.STATUS else None
        for output in self._server_outputs[part]:
            output.publish(message, latched_by)

    def learn_type(self, part: Ros1ActionTopic, info: TypeInfo) -> bool:
        """Take the type of a part from the server; False if it is another than before."""
        return all(output.learn_type(info) for output in self._server_outputs[part])

    def clear_latched_status(self) -> None:
        """Keep no status for late clients: the server that told it is gone."""
        for output in self._server_outputs[Ros1ActionTopic.STATUS]:
            output.clear_latched()

    def reaches_server(self, node: str) -> bool:
        """Tell whether cancels reach the server."""
        return any(output.is_subscribed_by(node) for output in self._cancel_outputs)

    def reaches_client(self, node: str) -> bool:
        """Tell whether results reach a client."""
        outputs = self._server_outputs[Ros1ActionTopic.RESULT]
        return any(output.is_subscribed_by(node) for output in outputs)

    def _open_cancel_topics(self) -> None:
        stream, topic = self._stream, ros1_topic_name(self._stream.action, Ros1ActionTopic.CANCEL)
        self._cancel_outputs = [
            self._advertise(output_topic(topic), CANCEL),
            self._advertise(topic, CANCEL),
        ]
        for flow in stream.flows:
            private = flow_topic(topic, flow.name)
            if any(matches_node(flow.publisher, node) for node in stream.successors):
                self._cancel_outputs.append(self._advertise(private, CANCEL))
            connect = partial(self._connect_client, flow.name, flow.publisher)
            self._transport.subscribe(self._node, private, CANCEL, connect, DEFAULT_INPUT)
        connect = partial(self._connect_client, UNAPPROVED, "*")
        self._transport.subscribe(self._node, topic, CANCEL, connect, DEFAULT_INPUT)

    def _open_server_topics(self, part: Ros1ActionTopic) -> None:
        topic = ros1_topic_name(self._stream.action, part)
        type = STATUS if part is Ros1ActionTopic.STATUS else ""
        names = (output_topic(topic), topic)
        self._server_outputs[part] = [self._advertise(name, type) for name in names]
        source, connect = flow_topic(topic, SERVER_FLOW), partial(self._connect_server, part)
        options = InputOptions(on_lost=partial(self._listener.on_server_lost, part))
        self._transport.subscribe(self._node, source, type, connect, options)

    def _advertise(self, topic: str, type: str) -> Output:
        options = OutputOptions(queue_size=self._stream.queue_size)
        output = self._transport.advertise(self._node, topic, type, options)
        info = standard_info(type, Encoding.ROS1) if type else None
        if info:
            output.learn_type(info)
        return output

    def _connect_client(self, flow: str, publisher: str, peer: Peer) -> MessageHandler | None:
        approved = peer.verified and matches_node(publisher, peer.node)
        return self._listener.cancel_receiver(flow if approved else UNAPPROVED, peer)

    def _connect_server(self, part: Ros1ActionTopic, peer: Peer) -> MessageHandler | None:
        serves = any(matches_node(node, peer.node) for node in self._stream.successors)
        if not (peer.verified and serves and self.learn_type(part, peer.info)):
            return None
        return self._listener.server_receiver(part, peer)
