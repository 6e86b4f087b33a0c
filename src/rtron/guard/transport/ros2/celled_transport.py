"""A transport for ROS 2 of which some topics are in cells, where only the guard reaches a node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.cell.access import WATCH, CellAccess
from rtron.guard.cell.connection import CellConnection
from rtron.guard.cell.ros2.carried_output import CarriedOutput
from rtron.guard.cell.ros2.carried_side import CarriedSide
from rtron.guard.transport.common.output_group import OutputGroup
from rtron.guard.transport.common.protocol import (
    DEFAULT_INPUT,
    ConnectHandler,
    InputOptions,
    LostHandler,
    Output,
    ignore_lost,
)
from rtron.guard.transport.ros2.middleware import Ros2Transport
from rtron.vocabulary import Plan, cell_topics

if TYPE_CHECKING:
    import socket

    from rtron.guard.core.event_loop import EventLoop
    from rtron.wire.ros2.session import Ros2Session

Ros2Cell = CellConnection[CarriedSide]


def open_ros2_cell(loop: EventLoop, address: str, node: str, role: bytes) -> Ros2Cell:
    """Return the cell of a node in a domain; it need not be there yet."""
    access = CellAccess(address, node)

    def open_side(sockets: list[socket.socket]) -> CarriedSide:
        for each in sockets:
            each.close()
        return CarriedSide(loop, access.connect_carrier(), role, lambda: cell.renew())  # noqa: PLW0108

    cell: Ros2Cell = CellConnection(loop, access, open_side, role=WATCH)
    return cell


class CelledRos2Transport(Ros2Transport):
    """Publishes and subscribes in a cell what the plan's node there has a side in."""

    def __init__(
        self, loop: EventLoop, session: Ros2Session, plan: Plan, address: str, role: bytes
    ) -> None:
        super().__init__(loop, session)
        self._loop, self._address, self._role = loop, address, role
        self._topics = {node: cell_topics(plan, node) for node in plan.cell}
        self._cells: dict[str, Ros2Cell] = {}
        if role != WATCH:
            for node in plan.cell:
                self._cell(node)

    def advertise(
        self,
        node: str,
        topic: str,
        type: str,
        *,
        queue_size: int = 100,
        keep_all: bool = False,
        successors: tuple[str, ...] = (),
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`."""
        cells = [self._cell(each) for each, has in self._topics.items() if topic in has.subscribed]
        outputs: list[Output] = []
        for cell in cells:
            output = CarriedOutput(
                node, topic, type, queue_size=queue_size, keep_all=keep_all, successors=successors
            )
            cell.apply(output.attach)
            outputs.append(output)
        if not cells or self._is_shared(topic):
            outside = super().advertise(
                node, topic, type, queue_size=queue_size, keep_all=keep_all, successors=successors
            )
            outputs.append(outside)
        return OutputGroup(outputs) if len(outputs) > 1 else outputs[0]

    def subscribe(
        self,
        node: str,
        topic: str,
        type: str,
        on_connect: ConnectHandler,
        on_lost: LostHandler = ignore_lost,
        options: InputOptions = DEFAULT_INPUT,
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`."""
        arguments = (node, topic, type, on_connect, on_lost, options)
        cells = [self._cell(each) for each, has in self._topics.items() if topic in has.published]
        for cell in cells:
            cell.apply(lambda side: side.subscribe(*arguments))
        if not cells or self._is_shared(topic):
            super().subscribe(*arguments)

    def close(self) -> None:
        """Leave the cells and the domain."""
        for cell in self._cells.values():
            cell.close()
        super().close()

    def _is_shared(self, topic: str) -> bool:
        return any(topic in topics.shared for topics in self._topics.values())

    def _cell(self, node: str) -> Ros2Cell:
        """Return the cell of a node; who only watches takes a carrier when it needs one."""
        if node not in self._cells:
            self._cells[node] = open_ros2_cell(self._loop, self._address, node, self._role)
        return self._cells[node]
