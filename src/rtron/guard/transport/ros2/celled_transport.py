"""A transport for ROS 2 of which some topics are in cells, where only the guard reaches a node."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.cell.access import WATCH, CellAccess
from rtron.guard.cell.connection import CellConnection
from rtron.guard.cell.ros2.carried_output import CarriedOutput
from rtron.guard.cell.ros2.carried_side import CarriedSide
from rtron.guard.transport.common.cell_routes import CellRoutes
from rtron.guard.transport.common.protocol import (
    DEFAULT_OUTPUT,
    ConnectHandler,
    InputOptions,
    Output,
    OutputOptions,
)
from rtron.guard.transport.ros2.middleware import Ros2Transport

if TYPE_CHECKING:
    import socket

    from rtron.guard.core.event_loop import EventLoop
    from rtron.vocabulary import Plan
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
    """Publishes and subscribes in a cell what the plan's node there has a side in.

    Who only watches takes a carrier when it needs one.
    """

    def __init__(
        self, loop: EventLoop, session: Ros2Session, plan: Plan, address: str, role: bytes
    ) -> None:
        super().__init__(loop, session)
        open_cell = partial(open_ros2_cell, loop, address, role=role)
        self._routes = CellRoutes(plan, open_cell, at_once=role != WATCH)

    def advertise(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`."""

        def inside(cell: Ros2Cell) -> Output:
            output = CarriedOutput(node, topic, type, options)
            cell.apply(output.attach)
            return output

        outside = partial(super().advertise, node, topic, type, options)
        return self._routes.advertise(topic, inside, outside)

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`."""
        arguments = (node, topic, type, on_connect, options)
        outside = partial(super().subscribe, *arguments)
        self._routes.subscribe(topic, lambda side: side.subscribe(*arguments), outside)

    def close(self) -> None:
        """Leave the cells and the domain."""
        self._routes.close()
        super().close()
