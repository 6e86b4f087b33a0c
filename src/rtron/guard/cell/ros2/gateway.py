"""What passes in and out of a cell on ROS 2: topics and services."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.cell.access import WATCH
from rtron.guard.cell.ros2.carried_output import CarriedOutput
from rtron.guard.cell.ros2.service_relay import CalledRelay, ServedRelay
from rtron.guard.cell.topic_relay import CellRefusals, TopicRelay, open_published
from rtron.guard.transport.factory import open_ros2_transport
from rtron.guard.transport.ros2.celled_transport import open_ros2_cell
from rtron.vocabulary import GATEWAY_NODE, CellManifest

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.cell.ros2.carried_side import CarriedSide
    from rtron.guard.core.event_loop import EventLoop


class Ros2Gateway:
    """The node outside that stands for the one in the cell: it has its name and what passes."""

    def __init__(self, loop: EventLoop, address: str, manifest: CellManifest) -> None:
        self._loop = loop
        self._manifest = manifest
        self._refusals = CellRefusals(manifest.node, loop.now)
        self._outside = open_ros2_transport(address, loop, node=manifest.node)
        self._cell = open_ros2_cell(loop, address, manifest.node, WATCH)
        self._on_ready: Callable[[], None] = lambda: None

    def open(self, on_ready: Callable[[], None]) -> None:
        """Begin to carry; `on_ready` is called when the node can start."""
        open_published(self._manifest, self._outside, self._cell, self._refusals)
        for topic in self._manifest.subscribed:
            inward = CarriedOutput(GATEWAY_NODE, topic.topic, topic.type)
            self._cell.apply(inward.attach)
            TopicRelay(topic, inward, self._refusals).open(self._outside, self._manifest.node)
        self._open_services()
        self._on_ready = on_ready
        self._cell.apply(self._start)

    def close(self) -> None:
        """Leave the domain outside; the cell ends by itself."""
        self._cell.close()
        self._outside.close()

    def _start(self, _side: CarriedSide) -> None:
        """Let the node start when there is a carrier, and not again with the next one."""
        on_ready, self._on_ready = self._on_ready, lambda: None
        on_ready()

    def _open_services(self) -> None:
        loop, node, outside = self._loop, self._manifest.node, self._outside
        for service in self._manifest.served:
            self._cell.apply(ServedRelay(loop, service, node, outside, self._refusals).attach)
        for service in self._manifest.called:
            self._cell.apply(CalledRelay(loop, service, node, outside).attach)
