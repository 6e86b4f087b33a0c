"""A topic that is published in a cell of ROS 2; it outlasts the carrier that publishes it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rtron.guard.cell.ros2.messages import ClearLatched, Publish
from rtron.guard.transport.common.protocol import DEFAULT_OUTPUT
from rtron.vocabulary import QoS, normalise_type

if TYPE_CHECKING:
    from rtron.guard.cell.ros2.carried_side import CarriedSide
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
        self._publisher = Publish(id=0, node=node, topic=topic, type=type, options=options)
        self._side: CarriedSide | None = None
        self._latched: dict[str, bytes] = {}
        self._latch_numbers: dict[str, int] = {}
        self._greeting: Greeting | None = None

    def attach(self, side: CarriedSide) -> None:
        """Publish with a carrier from now on."""
        self._side = side
        self._want(id=side.add_output(self))
        for latched_by, message in self._latched.items():
            self._send_data(message, latched_by)

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is another."""
        known = self._publisher.info
        if known is not None:
            return known.md5sum == info.md5sum and known.type == info.type
        if normalise_type(self._publisher.type) not in ("", normalise_type(info.type)):
            return False
        self._want(info=info)
        return True

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer at least the QoS of a flow's publisher."""
        if self._publisher.offers.get(flow) != qos:
            self._want(offers=self._publisher.offers | {flow: qos})

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer these nodes the QoS that they request."""
        self._want(matched=successors)

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber; see `Output`."""
        if latched_by is not None:
            self._latched.pop(latched_by, None)
            self._latched[latched_by] = message
        self._send_data(message, latched_by)

    def greet(self, greeting: Greeting) -> None:
        """Send the message of `greeting` to each new subscriber."""
        self._greeting = greeting
        self._want(is_greeting=True)

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
        if self._side:
            self._side.send(ClearLatched(self._publisher.id))

    def _want(self, **changes: Any) -> None:  # noqa: ANN401 - fields of `Publish`
        self._publisher = replace(self._publisher, **changes)
        if self._side:
            self._side.send(self._publisher)

    def _send_data(self, message: bytes, latched_by: str | None) -> None:
        latch = 0
        if latched_by is not None:
            latch = self._latch_numbers.setdefault(latched_by, len(self._latch_numbers) + 1)
        if self._side and not self._side.send_data(self._publisher.id, message, latch):
            self.lost += 1
