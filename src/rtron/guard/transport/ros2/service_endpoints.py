"""A service that a node of ours offers or calls, with requests and responses as bytes (CDR)."""

from __future__ import annotations

import logging
from functools import partial
from typing import TYPE_CHECKING, Any

from rclpy.qos import qos_profile_services_default
from rclpy.serialization import deserialize_message, serialize_message

from rtron.errors import WireError
from rtron.guard.transport.ros2.graph_query import GraphQuery
from rtron.guard.transport.ros2.rcl import EventFd
from rtron.guard.transport.ros2.responses import ResponseRetry
from rtron.guard.transport.ros2.service_calls import ServiceCalls
from rtron.vocabulary import Direction, matches_node
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.service_names import request_topic

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.transport.ros2.context import TransportContext

log = logging.getLogger(__name__)


class OfferedService:
    """Passes on each request with its id, by which it is answered; offered while it is open.

    SourceError if the type is not installed.
    """

    def __init__(
        self,
        node: Node,
        name: str,
        type: str,
        context: TransportContext,
        on_request: Callable[[bytes, bytes], None],
    ) -> None:
        self._node = node
        self._name = name
        self._cls: Any = find_interface(type).cls
        self._context = context
        self._on_request = on_request
        self._calls = ServiceCalls(context.sender_ids)
        self._retry = ResponseRetry(context.loop, name)
        self._clients = GraphQuery(node, raw=True)
        self._service: Any = None
        self._event_fd: EventFd | None = None

    def open(self) -> None:
        """Be there for clients."""
        if self._service is None:
            qos = qos_profile_services_default
            self._service = self._node.create_service(
                self._cls, self._name, lambda _request, response: response, qos_profile=qos
            )
            self._event_fd = EventFd(self._context.loop, self._on_requests)
            self._context.rcl.notify("service", self._service.handle, self._event_fd.fd)

    def close(self) -> None:
        """Be there no more."""
        if self._service is not None and self._event_fd:
            self._node.destroy_service(self._service)
            self._event_fd.stop()
        self._service = self._event_fd = None

    def find_client(self, request_id: bytes, expected: tuple[str, ...]) -> tuple[str, bool]:
        """Return the node that sent a request, "" if it is not known yet, and if it is expected.

        Two participants with one name are both none that is expected.
        """
        clients = self._clients.endpoints(request_topic(self._name), Direction.PUBLISH, ())
        participant = request_id[:PARTICIPANT_SIZE]
        own = [each.node for each in clients if each.participant == participant and each.node]
        others = {each.node for each in clients if each.participant != participant}
        for node in own:
            if node not in others and any(matches_node(name, node) for name in expected):
                return node, True
        return next(iter(own), ""), False

    def respond(self, request_id: bytes, response: bytes) -> None:
        """Answer a request; WireError if the response cannot be read."""
        message = _decode(response, self._cls.Response)
        send = partial(self._send, request_id, message)
        self._retry.send(request_id[:PARTICIPANT_SIZE], send)

    def _send(self, request_id: bytes, response: object) -> bool:
        if self._service is None:
            raise WireError("it is not offered any more")
        return self._calls.respond(self._service.handle, request_id, response)

    def _on_requests(self, count: int) -> None:
        for _ in range(count):
            taken = self._service and self._calls.take_request(
                self._service.handle, self._cls.Request
            )
            if taken:
                request_id, message = taken
                self._on_request(request_id, serialize_message(message.decode()))


class CalledService:
    """Sends requests, and passes on each response with the number of its request.

    SourceError if the type is not installed.
    """

    def __init__(
        self,
        node: Node,
        name: str,
        type: str,
        context: TransportContext,
        on_response: Callable[[int, bytes], None],
        part: str = "",
    ) -> None:
        """Call a service of a type, or of an action's type the `part` that is one."""
        self._node = node
        cls: Any = find_interface(type).cls
        self._cls = getattr(cls.Impl, part) if part else cls
        self._on_response = on_response
        self._calls = ServiceCalls(context.sender_ids)
        self._client = node.create_client(self._cls, name, qos_profile=qos_profile_services_default)
        self._event_fd = EventFd(context.loop, self._on_responses)
        context.rcl.notify("client", self._client.handle, self._event_fd.fd)

    @property
    def is_available(self) -> bool:
        """Whether somebody offers the service."""
        return bool(self._client.service_is_ready())

    def call(self, request: bytes) -> int:
        """Send a request, and return its number; WireError if it cannot be read."""
        message = _decode(request, self._cls.Request)
        return self._calls.send_request(self._client.handle, message)

    def close(self) -> None:
        """Leave the service."""
        self._node.destroy_client(self._client)
        self._event_fd.stop()

    def _on_responses(self, count: int) -> None:
        for _ in range(count):
            taken = self._calls.take_response(self._client.handle, self._cls.Response)
            if taken:
                number, response = taken
                self._on_response(number, serialize_message(response))


def _decode(message: bytes, cls: type) -> object:
    try:
        return deserialize_message(message, cls)
    except RuntimeError as error:
        raise WireError(f"it is no {cls.__name__}: {error}") from error
