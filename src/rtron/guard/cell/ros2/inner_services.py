"""The services that a carrier offers and calls in a cell of ROS 2, for its client outside."""

from __future__ import annotations

from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from rtron.errors import WireError
from rtron.guard.cell.ros2.messages import CallService, OfferService, ServiceState

if TYPE_CHECKING:
    from rtron.guard.cell.ros2.carrier_channel import CarrierChannel, TopicData
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.guard.transport.ros2.service_endpoints import CalledService, OfferedService

_MAX_CALLS = 1024
"""How many requests may wait for an answer; then the oldest gets none."""


class InnerServices:
    """Passes on requests of the node in the cell, and those to it."""

    def __init__(self, transport: Ros2Transport, channel: CarrierChannel) -> None:
        self._transport = transport
        self._channel = channel
        self._servers: dict[int, OfferedService] = {}
        self._clients: dict[int, CalledService] = {}
        self._is_available: dict[int, bool] = {}
        self._numbers = count(1)
        self._requests: dict[int, bytes] = {}
        self._calls: dict[tuple[int, int], int] = {}

    def has(self, id: int) -> bool:
        """Tell whether a number is that of a service."""
        return id in self._servers or id in self._clients

    def offer(self, request: OfferService) -> None:
        """Offer a service, or do so no more."""
        if request.id not in self._servers:
            on_request = partial(self._on_request, request.id)
            self._servers[request.id] = self._transport.create_server(
                request.node, request.service, request.type, on_request
            )
        server = self._servers[request.id]
        if request.is_offered:
            server.open()
        else:
            server.close()

    def open_client(self, request: CallService) -> None:
        """Call a service from now on."""
        if self.has(request.id):
            raise WireError("it requests a service twice")
        on_response = partial(self._on_response, request.id)
        self._clients[request.id] = self._transport.create_client(
            request.node, request.service, request.type, on_response
        )

    def receive(self, data: TopicData) -> None:
        """Send a request to the node, or a response."""
        if data.id in self._clients:
            number = self._clients[data.id].call(data.message)
            self._calls[data.id, number] = data.tag
            _drop_oldest(self._calls)
        elif request_id := self._requests.pop(data.tag, None):
            self._servers[data.id].respond(request_id, data.message)

    def report(self) -> None:
        """Tell which services have come or gone."""
        for id, client in self._clients.items():
            is_available = client.is_available
            if is_available != self._is_available.get(id, False):
                self._is_available[id] = is_available
                self._channel.send(ServiceState(id, is_available))

    def _on_request(self, id: int, request_id: bytes, message: bytes) -> None:
        number = next(self._numbers)
        self._requests[number] = request_id
        _drop_oldest(self._requests)
        self._channel.send_data(id, message, number)

    def _on_response(self, id: int, number: int, message: bytes) -> None:
        call = self._calls.pop((id, number), None)
        if call is not None:
            self._channel.send_data(id, message, call)


def _drop_oldest(calls: dict[int, bytes] | dict[tuple[int, int], int]) -> None:
    if len(calls) > _MAX_CALLS:
        del calls[next(iter(calls))]  # type: ignore[arg-type]
