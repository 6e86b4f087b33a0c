"""One topic that is published in several places: in cells, and outside."""

from collections.abc import Sequence

from rtron.guard.transport.common.protocol import Greeting, Output, TypeInfo
from rtron.vocabulary import QoS


class OutputGroup:
    """Does with each of some outputs what is asked of one; see `Output`."""

    def __init__(self, outputs: Sequence[Output]) -> None:
        self._outputs = outputs

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type from a publisher; False if it is not that of one of the outputs."""
        accepted = [output.learn_type(info) for output in self._outputs]
        return all(accepted)

    def offer(self, flow: str, qos: QoS) -> None:
        """Offer subscribers at least the QoS of a flow's publisher."""
        for output in self._outputs:
            output.offer(flow, qos)

    def match_subscribers(self, successors: tuple[str, ...]) -> None:
        """Offer these nodes the QoS that they request."""
        for output in self._outputs:
            output.match_subscribers(successors)

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Send to every subscriber."""
        for output in self._outputs:
            output.publish(message, latched_by)

    def greet(self, greeting: Greeting) -> None:
        """Send each new subscriber the message of `greeting` first."""
        for output in self._outputs:
            output.greet(greeting)

    def is_subscribed_by(self, node: str) -> bool:
        """Return whether a node that calls itself `node` subscribes."""
        return any(output.is_subscribed_by(node) for output in self._outputs)

    def clear_latched(self) -> None:
        """Latch no message any more."""
        for output in self._outputs:
            output.clear_latched()

    @property
    def lost(self) -> int:
        """How many messages did not reach a subscriber."""
        return sum(output.lost for output in self._outputs)
