"""What passes in and out of a cell on ROS 2: topics and services."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.cell.access import WATCH
from rtron.guard.cell.ros2.carried_output import CarriedOutput
from rtron.guard.cell.ros2.service_relay import CalledRelay, ServedRelay
from rtron.guard.cell.topic_relay import CellRefusals, TopicRelay
from rtron.guard.core.report_messages import DIAGNOSTICS, diagnostics_message
from rtron.guard.transport.factory import open_ros2_transport
from rtron.guard.transport.ros2.celled_transport import open_ros2_cell
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import GATEWAY_NODE, SECOND, CellManifest

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.cell.ros2.carried_side import CarriedSide
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import Output

_DIAGNOSTICS_TOPIC = "/diagnostics"


class Ros2Gateway:
    """The node outside that stands for the one in the cell: it has its name and what passes."""

    def __init__(self, loop: EventLoop, address: str, manifest: CellManifest) -> None:
        self._loop = loop
        self._manifest = manifest
        self._refusals = CellRefusals(manifest.node, loop.now)
        self._outside = open_ros2_transport(address, loop, node=manifest.node)
        self._cell = open_ros2_cell(loop, address, manifest.node, WATCH)
        self._on_ready: Callable[[], None] = lambda: None
        self._number = 0

    def open(self, on_ready: Callable[[], None]) -> None:
        """Begin to carry; `on_ready` is called when the node can start."""
        outputs: dict[str, Output] = {}
        for topic in self._manifest.published:
            output = self._outside.advertise(self._manifest.node, topic.topic, topic.type)
            outputs[topic.topic] = output
            relay = TopicRelay(topic, output, self._refusals)
            self._cell.apply(partial(_open_relay, relay))
        for topic in self._manifest.subscribed:
            inward = CarriedOutput(GATEWAY_NODE, topic.topic, topic.type)
            self._cell.apply(inward.attach)
            TopicRelay(topic, inward, self._refusals).open(self._outside, self._manifest.node)
        self._open_services()
        diagnostics = DIAGNOSTICS[Encoding.CDR]
        output = outputs.get(_DIAGNOSTICS_TOPIC) or self._outside.advertise(
            self._manifest.node, _DIAGNOSTICS_TOPIC, diagnostics.type
        )
        output.learn_type(diagnostics)
        self._report(output)
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

    def _report(self, output: Output) -> None:
        self._number += 1
        fields = (self._number, time.time_ns(), [self._refusals.status()])
        output.publish(diagnostics_message(Encoding.CDR, *fields))
        self._loop.call_at(self._loop.now() + SECOND, partial(self._report, output))


def _open_relay(relay: TopicRelay, side: CarriedSide) -> None:
    relay.open(side, GATEWAY_NODE)
