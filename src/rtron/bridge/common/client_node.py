"""A client's node in the ROS graph, as the bridge uses it: one name, its topics and its calls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rtron.bridge.protocol.effects import CancelGoal, RequestParameter, RequestService, SendGoal
    from rtron.bridge.protocol.frames import Document
    from rtron.bridge.rights.document import ClientRights
    from rtron.errors import RTronError


class NodeListener(Protocol):
    """Who hears what happens at a node; all calls come in the loop's thread."""

    def on_message(self, topic: str, message: bytes) -> None:
        """Take a message of a topic that the node reads."""
        ...

    def on_answer(self, number: int, answer: bytes | Document | RTronError) -> None:
        """Take the answer to the call of a number."""
        ...

    def on_feedback(self, number: int, feedback: bytes) -> None:
        """Take the feedback of the goal of a number."""
        ...

    def on_result(self, number: int, result: bytes | RTronError) -> None:
        """Take the result of the goal of a number, or why it has none."""
        ...

    def on_problem(self, reason: str) -> None:
        """Take what went wrong in the graph, as the client is to hear it."""
        ...

    def on_shutdown(self, reason: str) -> None:
        """Take that somebody shuts the node down."""
        ...


class ClientNode(Protocol):
    """A node of its own name. None of the calls waits; SourceError if a topic cannot be had."""

    def advertise(self, topic: str, type: str, listeners: tuple[str, ...]) -> None:
        """Publish a topic from now on, which these nodes of the guard hear, if any."""
        ...

    def withdraw(self, topic: str) -> None:
        """Publish a topic no more."""
        ...

    def publish(self, topic: str, message: bytes, *, is_latched: bool) -> None:
        """Publish a message on a topic that is advertised."""
        ...

    def read(self, topic: str, type: str) -> None:
        """Subscribe to a topic from now on."""
        ...

    def leave(self, topic: str) -> None:
        """Subscribe to a topic no more."""
        ...

    def call(self, request: RequestService) -> None:
        """Call a service; the listener gets the answer."""
        ...

    def access_parameter(self, request: RequestParameter) -> None:
        """Read or write a parameter; the listener gets the answer."""
        ...

    def send_goal(self, request: SendGoal) -> None:
        """Send a goal; the listener hears what becomes of it. Only in ROS 2."""
        ...

    def cancel_goal(self, request: CancelGoal) -> None:
        """Ask for the cancel of a goal."""
        ...

    def close(self) -> None:
        """Leave the graph; goals that are not done are cancelled."""
        ...


class NodeFactory(Protocol):
    """Opens the nodes of clients in one ROS graph."""

    def open(self, client: ClientRights, listener: NodeListener) -> ClientNode:
        """Return the node of a client."""
        ...

    def close(self) -> None:
        """Leave the graph with all nodes that are left."""
        ...
