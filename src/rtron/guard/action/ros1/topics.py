"""The topics of a guarded action beside its goals: to clients one node is the server, on all five.

Clients compare who subscribes their goals with who tells the status (actionlib's
`wait_for_server`), so all that faces them belongs to the first coordination node.
"""

from functools import partial
from typing import Protocol

from rtron.guard.core.message_types import standard_info
from rtron.guard.transport.common.protocol import Output, Peer, Receive, Transport, TypeInfo
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    ANSWERED,
    SERVER,
    UNAPPROVED,
    ActionPart,
    Stream,
    flow_topic,
    names_node,
    output_topic,
    part_topic,
)

CANCEL = "actionlib_msgs/GoalID"
STATUS = "actionlib_msgs/GoalStatusArray"


class Hears(Protocol):
    """Who is told what arrives on an action's topics."""

    def cancels_of(self, flow: str, peer: Peer) -> Receive | None:
        """Return what takes the cancels of a client."""
        ...

    def answers_of(self, part: ActionPart, peer: Peer) -> Receive | None:
        """Return what takes what the server says."""
        ...

    def server_left(self, part: ActionPart, peer: Peer) -> None:
        """Learn that the server does not publish a part any more."""
        ...


class ActionEnds:
    """The cancels, statuses, feedback and results of one action."""

    def __init__(self, stream: Stream, node: str, transport: Transport, hears: Hears) -> None:
        self._stream = stream
        self._node = node
        self._transport = transport
        self._hears = hears
        self._cancels: list[Output] = []
        self._answers: dict[ActionPart, list[Output]] = {}

    def open(self) -> None:
        """Join the graph."""
        self._open_cancels()
        for part in ANSWERED:
            self._open_answers(part)

    def cancel(self, message: bytes) -> None:
        """Send a cancel to the server."""
        for output in self._cancels:
            output.publish(message)

    def answer(self, part: ActionPart, message: bytes) -> None:
        """Send to the clients what the server said, or what is said in its place."""
        latched_by = SERVER if part is ActionPart.STATUS else None
        for output in self._answers[part]:
            output.publish(message, latched_by)

    def learn(self, part: ActionPart, info: TypeInfo) -> bool:
        """Take the type of a part from the server; False if it is another than before."""
        return all(output.learn(info) for output in self._answers[part])

    def forget(self) -> None:
        """Keep no status for late clients: the server that told it is gone."""
        for output in self._answers[ActionPart.STATUS]:
            output.forget()

    def reaches_server(self, node: str) -> bool:
        """Tell whether cancels reach the server."""
        return any(output.reaches(node) for output in self._cancels)

    def reaches_client(self, node: str) -> bool:
        """Tell whether results reach a client."""
        return any(output.reaches(node) for output in self._answers[ActionPart.RESULT])

    def _open_cancels(self) -> None:
        stream, topic = self._stream, part_topic(self._stream.action, ActionPart.CANCEL)
        self._cancels = [
            self._advertise(output_topic(topic), CANCEL),
            self._advertise(topic, CANCEL),
        ]
        for flow in stream.flows:
            private = flow_topic(topic, flow.name)
            if any(names_node(flow.publisher, node) for node in stream.successors):
                self._cancels.append(self._advertise(private, CANCEL))
            connect = partial(self._connect_client, flow.name, flow.publisher)
            self._transport.subscribe(self._node, private, CANCEL, connect)
        connect = partial(self._connect_client, UNAPPROVED, "*")
        self._transport.subscribe(self._node, topic, CANCEL, connect)

    def _open_answers(self, part: ActionPart) -> None:
        topic = part_topic(self._stream.action, part)
        type = STATUS if part is ActionPart.STATUS else ""
        names = (output_topic(topic), topic)
        self._answers[part] = [self._advertise(name, type) for name in names]
        self._transport.subscribe(
            self._node,
            flow_topic(topic, SERVER),
            type,
            partial(self._connect_server, part),
            partial(self._hears.server_left, part),
        )

    def _advertise(self, topic: str, type: str) -> Output:
        size = self._stream.queue_size
        output = self._transport.advertise(self._node, topic, type, queue_size=size)
        info = standard_info(type, Encoding.ROS1) if type else None
        if info:
            output.learn(info)
        return output

    def _connect_client(self, flow: str, publisher: str, peer: Peer) -> Receive | None:
        approved = peer.verified and names_node(publisher, peer.node)
        return self._hears.cancels_of(flow if approved else UNAPPROVED, peer)

    def _connect_server(self, part: ActionPart, peer: Peer) -> Receive | None:
        serves = any(names_node(node, peer.node) for node in self._stream.successors)
        if not (peer.verified and serves and self.learn(part, peer.info)):
            return None
        return self._hears.answers_of(part, peer)
