"""Services that pass between a cell of ROS 2 and the app; the gateway has one relay for each."""

from __future__ import annotations

from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from rtron.guard.cell.ros2.messages import CallService, OfferService
from rtron.guard.core.printable import printable
from rtron.vocabulary import GATEWAY_NODE, SECOND, CarriedService

if TYPE_CHECKING:
    from rtron.guard.cell.ros2.carried_side import CarriedSide
    from rtron.guard.cell.topic_relay import CellRefusals
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.middleware import Ros2Transport

_MAX_CALLS = 64
"""How many requests of a service may wait for an answer; then the oldest gets none."""
_NAME_TIMEOUT = SECOND
"""How long the domain may take to name a client, ns."""
_LOOK_S = 0.05


class ServedRelay:
    """Offers outside what the node in the cell serves, while it does, for the manifest's clients.

    Who calls is known by the name of its node, which ROS 2 does not protect.
    """

    def __init__(
        self,
        loop: EventLoop,
        service: CarriedService,
        node: str,
        outside: Ros2Transport,
        refusals: CellRefusals,
    ) -> None:
        self._loop = loop
        self._service = service
        self._refusals = refusals
        self._server = outside.create_server(node, service.service, service.type, self._on_request)
        self._numbers = count(1)
        self._waiting: dict[int, bytes] = {}
        self._unnamed = 0
        self._side: CarriedSide | None = None
        self._id = 0

    def attach(self, side: CarriedSide) -> None:
        """Call by a carrier from now on."""
        self._waiting.clear()
        self._side, self._id = side, side.add_service(self)
        name, type = self._service.service, self._service.type
        side.send(CallService(self._id, GATEWAY_NODE, name, type))

    def set_available(self, *, is_available: bool) -> None:
        """Offer the service while the node does."""
        if is_available:
            self._server.open()
        else:
            self._server.close()

    def receive(self, call: int, message: bytes) -> None:
        """Answer the client."""
        if request_id := self._waiting.pop(call, None):
            self._server.respond(request_id, message)

    def _on_request(self, request_id: bytes, message: bytes) -> None:
        self._admit(request_id, message, self._loop.now())

    def _admit(self, request_id: bytes, message: bytes, since: int) -> None:
        client, is_listed = self._server.find_client(request_id, self._service.clients)
        if is_listed:
            self._call(request_id, message)
        elif not client and self._may_wait(since):
            self._unnamed += 1
            self._loop.call_later(_LOOK_S, partial(self._admit_again, request_id, message, since))
        else:
            name = printable(client) or "a client without a name"
            reason = "the manifest does not name it as a client, or two have its name"
            self._refusals.report(f"{name} to {self._service.service}", reason)

    def _admit_again(self, request_id: bytes, message: bytes, since: int) -> None:
        self._unnamed -= 1
        self._admit(request_id, message, since)

    def _may_wait(self, since: int) -> bool:
        """Tell whether a request may wait for its client's name; strangers can send any number."""
        return self._unnamed < _MAX_CALLS and self._loop.now() - since < _NAME_TIMEOUT

    def _call(self, request_id: bytes, message: bytes) -> None:
        number = next(self._numbers)
        self._waiting[number] = request_id
        if len(self._waiting) > _MAX_CALLS:
            del self._waiting[next(iter(self._waiting))]
            reason = f"{_MAX_CALLS} others wait for an answer"
            self._refusals.report(f"a call of {self._service.service}", reason)
        if self._side:
            self._side.send_data(self._id, message, number)


class CalledRelay:
    """Offers inside what the node in the cell calls outside, while somebody serves it there."""

    def __init__(
        self, loop: EventLoop, service: CarriedService, node: str, outside: Ros2Transport
    ) -> None:
        self._loop = loop
        self._service = service
        self._client = outside.create_client(node, service.service, service.type, self._answer)
        self._calls: dict[int, int] = {}
        self._side: CarriedSide | None = None
        self._id = 0
        self._is_offered = False
        self._look()

    def attach(self, side: CarriedSide) -> None:
        """Offer it by a carrier from now on."""
        self._calls.clear()
        self._side, self._id, self._is_offered = side, side.add_service(self), False

    def set_available(self, *, is_available: bool) -> None:
        """Do nothing: the node does not serve it."""

    def receive(self, call: int, message: bytes) -> None:
        """Send a request of the node."""
        self._calls[self._client.call(message)] = call
        if len(self._calls) > _MAX_CALLS:
            del self._calls[next(iter(self._calls))]

    def _answer(self, number: int, message: bytes) -> None:
        call = self._calls.pop(number, None)
        if self._side and call is not None:
            self._side.send_data(self._id, message, call)

    def _look(self) -> None:
        """Follow who serves it; a node may wait for it."""
        self._loop.call_later(_LOOK_S, self._look)
        is_available = self._client.is_available
        if self._side and is_available != self._is_offered:
            self._is_offered = is_available
            name, type = self._service.service, self._service.type
            self._side.send(OfferService(self._id, GATEWAY_NODE, name, type, is_available))


CarriedCalls = ServedRelay | CalledRelay
"""What a carrier has to do with a service."""
