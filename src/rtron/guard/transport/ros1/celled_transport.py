"""A transport for ROS 1 of which some topics are in cells, where only the guard reaches a node."""

import socket
from collections.abc import Sequence
from functools import partial

from rtron.guard.cell.access import CellAccess, CellNetwork
from rtron.guard.cell.connection import CellConnection
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.cell_routes import CellRoutes
from rtron.guard.transport.common.protocol import (
    DEFAULT_OUTPUT,
    ConnectHandler,
    InputOptions,
    Output,
    OutputOptions,
    SubscriberProgress,
)
from rtron.guard.transport.ros1.middleware import Ros1Transport, TypedPublication
from rtron.vocabulary import Plan

CELL_HOST = "127.0.0.1"
PUBLIC_PORT, PRIVATE_PORT = 11311, 11312
"""Where the master of a cell listens: for its node, and for the guard."""
PRIVATE_MASTER = f"http://{CELL_HOST}:{PRIVATE_PORT}/"

Ros1Cell = CellConnection[Ros1Transport]


def open_ros1_cell(loop: EventLoop, address: str, node: str, role: bytes) -> Ros1Cell:
    """Return the cell of a node at a master; it need not be there yet."""
    access = CellAccess(address, node)

    def open_side(pool: list[socket.socket]) -> Ros1Transport:
        return Ros1Transport(loop, PRIVATE_MASTER, CELL_HOST, network=CellNetwork(access, pool))

    return CellConnection(loop, access, open_side, role=role)


class CelledTransport(Ros1Transport):
    """Publishes and subscribes in a cell what the plan's node there has a side in.

    Where nodes outside share the topic, it is outside, too. All nodes, questions and answers of
    this transport but `subscriber_progress` are those outside.
    """

    def __init__(
        self, loop: EventLoop, master: str, plan: Plan, *, public: str, role: bytes
    ) -> None:
        super().__init__(loop, master, public=public)
        open_cell = partial(open_ros1_cell, loop, public, role=role)
        self._routes = CellRoutes(plan, open_cell)
        self._inside: dict[str, list[tuple[Ros1Cell, TypedPublication]]] = {}

    def advertise(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`."""

        def inside(cell: Ros1Cell) -> Output:
            publication = TypedPublication(node, topic, type, self.now, options)
            self._inside.setdefault(topic, []).append((cell, publication))
            cell.apply(lambda side: side.add_publication(publication))
            return publication

        outside = partial(super().advertise, node, topic, type, options)
        return self._routes.advertise(topic, inside, outside)

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`."""
        arguments = (node, topic, type, on_connect, options)
        outside = partial(super().subscribe, *arguments)
        self._routes.subscribe(topic, lambda side: side.subscribe(*arguments), outside)

    def subscriber_progress(self, topic: str) -> Sequence[SubscriberProgress]:
        """Return how far each subscriber of a topic has come, in the cells or outside."""
        inside = [
            progress
            for cell, publication in self._inside.get(topic, ())
            if cell.side
            for progress in cell.side.subscriber_progress(topic)
        ]
        return [*inside, *super().subscriber_progress(topic)]

    def close(self) -> None:
        """Leave the cells and the graph."""
        self._routes.close()
        super().close()
