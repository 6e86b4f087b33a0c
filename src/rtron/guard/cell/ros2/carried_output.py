"""A topic that is published in a cell of ROS 2; it outlasts the carrier that publishes it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rtron.guard.cell.ros2.messages import (
    Advertise,
    ClearLatched,
    Greet,
    LearnType,
    MatchSubscribers,
    Offer,
)
from rtron.guard.transport.common.protocol import DEFAULT_OUTPUT
from rtron.vocabulary import QoS, normalise_type

if TYPE_CHECKING:
    from rtron.guard.cell.ros2.carried_side import CarriedSide
    from rtron.guard.cell.ros2.messages import ToCarrier
    from rtron.guard.transport.common.protocol import Greeting, OutputOptions, TypeInfo


class CarriedOutput:
    """See `Output`."""

    def __init__(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> None:
        self.nodes: frozenset[str] = frozenset()
        """Who of the successors subscribes."""
        self.lost = 0
        """How many messages the carrier was too slow for; it does not tell of the node's end."""
        self._request = Advertise(0, node, topic, type, options)
        self._id = 0
        self._side: CarriedSide | None = None
        self._info: TypeInfo | None = None
        self._offers: dict[str, QoS] = {}
        self._latched: dict[str, bytes] = {}
        self._latch_numbers: dict[str, int] = {}
        self._matched: tuple[str, ...] = ()
        self._greeting: Greeting | None = None

    def attach(self, side: CarriedSide) -> None:
        """Publish with a carrier from now on."""
        self._side, self._id = side, side.add_output(self)
        side.send(replace(self._request, id=self._id))
        if self._info:
            side.send(LearnType(self._id, self._info))
        if self._matched:
            side.send(MatchSubscribers(self._id, self._matched))
        for flow, qos in self._offers.items():
            side.send(Offer(self._id, flow, qos))
        if self._greeting:
            side.send(Greet(self._id))
        for latched_by, message in self._latched.items():
            self._send_data(message, latched_by)

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is another."""
        if self._info is not None:
            return self._info.md5sum == info.md5sum and self._info.type == info.type
        if normalise_type(self._request.type) not in ("", normalise_type(info.type)):
            return False
        self._info = info
        self._send(LearnType(self._id, info))
        return True

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer at least the QoS of a flow's publisher."""
        if self._offers.get(flow) != qos:
            self._offers[flow] = qos
            self._send(Offer(self._id, flow, qos))

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer these nodes the QoS that they request."""
        self._matched = successors
        self._send(MatchSubscribers(self._id, successors))

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; see `Output`."""
        if latched_by is not None:
            self._latched.pop(latched_by, None)
            self._latched[latched_by] = message
        self._send_data(message, latched_by)

    def greet(self, greeting: Greeting) -> None:
        """Send the message of `greeting` to each new subscriber."""
        self._greeting = greeting
        self._send(Greet(self._id))

    def send_greeting(self) -> None:
        """Send the greeting, if there is one now."""
        message = self._greeting() if self._greeting else None
        if message is not None:
            self.publish(message)

    def is_subscribed_by(self, node: str) -> bool:
        """Return whether a node subscribes."""
        return node in self.nodes

    def clear_latched(self) -> None:
        """Latch no message any more."""
        self._latched.clear()
        self._send(ClearLatched(self._id))

    def _send(self, message: ToCarrier) -> None:
        if self._side:
            self._side.send(message)

    def _send_data(self, message: bytes, latched_by: str | None) -> None:
        latch = 0
        if latched_by is not None:
            latch = self._latch_numbers.setdefault(latched_by, len(self._latch_numbers) + 1)
        if self._side and not self._side.send_data(self._id, message, latch):
            self.lost += 1
