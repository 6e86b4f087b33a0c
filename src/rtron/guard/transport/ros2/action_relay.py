"""The ends of a guarded action of ROS 2: its server's private name, each flow's, and the public."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from rtron.guard.transport.common.protocol import TypeInfo
from rtron.guard.transport.ros2.action_client import ActionClient
from rtron.guard.transport.ros2.action_server import ActionContext, ActionServer
from rtron.guard.transport.ros2.service_calls import ServiceCalls
from rtron.vocabulary import SECOND, UNAPPROVED, Ros2ActionEntity, Stream, flow_topic, output_topic
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.node import Node

    from rtron.guard.action.ros2.endpoints import (
        CancelReply,
        GoalReply,
    )
    from rtron.guard.action.ros2.stream import Ros2ActionStream
    from rtron.guard.transport.ros2.action_server import ResultResponder
    from rtron.guard.transport.ros2.context import TransportContext
    from rtron.messages.ros2.actions import GoalMessage

log = logging.getLogger(__name__)

_OFFER_TIMEOUT = 5 * SECOND
"""So long the action is offered although its server is away: a client waits for one that is not."""


class ActionRelay:
    """Towards the clients the action is offered once its server is there, and while it is.

    SourceError if the type is not installed.
    """

    def __init__(
        self, stream: Stream, node: Node, listener: Ros2ActionStream, context: TransportContext
    ) -> None:
        interface_type = find_interface(stream.type)
        self.type_info = TypeInfo(
            interface_type.name, interface_type.md5sum, interface_type.definition
        )
        action_context = ActionContext(
            node, interface_type.cls, self.type_info, context, ServiceCalls(context.sender_ids)
        )
        self._listener = listener
        self._loop = context.loop
        self._client = ActionClient(
            output_topic(stream.action), stream.successors, self, action_context
        )
        flows = [(flow_topic(stream.action, f.name), f.name, f.publisher) for f in stream.flows]
        names = [*flows, (stream.action, UNAPPROVED, "*")]
        self._servers = {
            flow: ActionServer(name, flow, publisher, listener, action_context)
            for name, flow, publisher in names
        }
        self._departures = 0
        self._is_server_available = False

    def open(self) -> None:
        """Join the graph."""
        self._client.open()

    def close(self) -> None:
        """Leave the graph."""
        self._client.close()
        for server in self._servers.values():
            server.destroy()

    def send_goal(self, goal: GoalMessage, on_reply: GoalReply) -> None:
        """Send a goal to the server."""
        self._client.send_goal(goal, on_reply)

    def cancel(self, id: bytes, stamp: int, on_reply: CancelReply) -> None:
        """Send a cancel to the server."""
        self._client.cancel(id, stamp, on_reply)

    def get_result(self, id: bytes, on_reply: Callable[[int, object], None]) -> None:
        """Ask the server for a result."""
        self._client.get_result(id, on_reply)

    def publish(
        self, end: Ros2ActionEntity, message: bytes, flows: Sequence[str] | None = None
    ) -> None:
        """Tell the clients of some flows, or all, and whoever listens under the public name."""
        chosen = self._servers if flows is None else dict.fromkeys((*flows, UNAPPROVED))
        for flow in chosen:
            if flow in self._servers:
                self._servers[flow].publish(end, message)

    def restore_reply(self, token: str) -> ResultResponder | None:
        """Return the place of a request that came to the guard before."""
        flow, _, request_id = token.partition(" ")
        server = self._servers.get(flow)
        return server.restore_reply(request_id) if server else None

    def on_server_available(self, node: str, incarnation: bytes) -> None:
        """Offer the action, and tell."""
        log.info("the server %s is there", node)
        self._is_server_available = True
        for server in self._servers.values():
            server.open()
        self._listener.on_server_available(node, incarnation)

    def on_server_message(self, end: Ros2ActionEntity, message: bytes) -> None:
        """Tell what the server says."""
        self._listener.on_server_message(end, message)

    def on_server_doubt(self, reason: str) -> None:
        """Tell."""
        self._listener.on_server_doubt(reason)

    def on_server_lost(self) -> None:
        """Tell, and offer the action no more after a while."""
        self._is_server_available, self._departures = False, self._departures + 1
        departure = self._departures

        def close() -> None:
            if not self._is_server_available and departure == self._departures:
                for server in self._servers.values():
                    server.close()

        self._listener.on_server_lost()
        self._loop.call_at(self._loop.now() + _OFFER_TIMEOUT, close)
