"""Where the topics of a plan with cells lead: into cells, outside, or both."""

from collections.abc import Callable, Sequence
from typing import Generic

from rtron.guard.cell.connection import CellConnection, Side
from rtron.guard.transport.common.protocol import Greeting, Output, TypeInfo
from rtron.vocabulary import Plan, QoS, cell_topics


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


class CellRoutes(Generic[Side]):
    """A topic is in each cell whose node has a side in it, and outside where others share it."""

    def __init__(
        self, plan: Plan, open_cell: Callable[[str], CellConnection[Side]], *, at_once: bool = True
    ) -> None:
        """`open_cell` takes a node, `at_once` or when the first topic leads to it."""
        self._topics = {node: cell_topics(plan, node) for node in plan.cell}
        self._open_cell = open_cell
        self._cells: dict[str, CellConnection[Side]] = {}
        for node in plan.cell if at_once else ():
            self._cell(node)

    def advertise(
        self,
        topic: str,
        inside: Callable[[CellConnection[Side]], Output],
        outside: Callable[[], Output],
    ) -> Output:
        """Publish a topic wherever it leads."""
        cells = [self._cell(node) for node, has in self._topics.items() if topic in has.subscribed]
        outputs = [inside(cell) for cell in cells]
        if not cells or self._is_shared(topic):
            outputs.append(outside())
        return OutputGroup(outputs) if len(outputs) > 1 else outputs[0]

    def subscribe(
        self, topic: str, inside: Callable[[Side], object], outside: Callable[[], None]
    ) -> None:
        """Subscribe to a topic wherever it comes from."""
        cells = [self._cell(node) for node, has in self._topics.items() if topic in has.published]
        for cell in cells:
            cell.apply(inside)
        if not cells or self._is_shared(topic):
            outside()

    def close(self) -> None:
        """Leave the cells."""
        for cell in self._cells.values():
            cell.close()

    def _is_shared(self, topic: str) -> bool:
        return any(topic in has.shared for has in self._topics.values())

    def _cell(self, node: str) -> CellConnection[Side]:
        if node not in self._cells:
            self._cells[node] = self._open_cell(node)
        return self._cells[node]
