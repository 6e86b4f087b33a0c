"""A topic that passes between a cell and the app, and what a cell refuses to carry."""

import logging
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from rtron.guard.cell.connection import CellConnection
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.core.report_messages import DIAGNOSTICS, OK, WARN, Status, diagnostics_message
from rtron.guard.transport.common.protocol import (
    InputOptions,
    MessageHandler,
    Output,
    Peer,
    Transport,
)
from rtron.vocabulary import GATEWAY_NODE, SECOND, CarriedTopic, CellManifest, matches_node

if TYPE_CHECKING:
    from rtron.guard.cell.ros2.carried_side import CarriedSide

log = logging.getLogger(__name__)

_QUEUE_SIZE = 100
_MAX_SUBJECTS = 64
_REST = "others"
_DIAGNOSTICS_TOPIC = "/diagnostics"


class CellRefusals:
    """Counts what is refused by its subject; strangers may have any number of names."""

    def __init__(self, node: str, now: Callable[[], int]) -> None:
        self._node = node
        self._now = now
        self._log_throttle = LogThrottle()
        self._counts: Counter[str] = Counter()

    def report(self, subject: str, reason: str) -> None:
        """Tell that something was refused: what, and why."""
        is_known = subject in self._counts or len(self._counts) < _MAX_SUBJECTS
        key = subject if is_known else _REST
        self._counts[key] += 1
        if self._log_throttle.allows(key, self._now()):
            log.warning("cell of %s: %s is refused: %s", self._node, subject, reason)

    def publish(self, output: Output, transport: Transport, number: int = 1) -> None:
        """Tell what was refused in the diagnostics, each second from now on."""
        message = diagnostics_message(transport.encoding, number, time.time_ns(), [self._status()])
        output.publish(message)
        next_call = partial(self.publish, output, transport, number + 1)
        transport.call_at(transport.now() + SECOND, next_call)

    def _status(self) -> Status:
        total = self._counts.total()
        message = f"{total} refusals" if total else "nothing was refused"
        values = {subject: str(count) for subject, count in self._counts.items()}
        return Status(WARN if total else OK, f"rtron: cell of {self._node}", message, values)


class TopicRelay:
    """Passes on the messages of the publishers that the manifest names, byte by byte.

    What a publisher latches is latched on the other side, until it is gone.
    """

    def __init__(self, topic: CarriedTopic, output: Output, refusals: CellRefusals) -> None:
        self._topic = topic
        self._output = output
        self._refusals = refusals

    def open(self, source: "Transport | CarriedSide", node: str) -> None:
        """Take the topic from a transport, as a node."""
        topic = self._topic
        options = InputOptions(
            publishers=topic.publishers, queue_size=_QUEUE_SIZE, on_lost=self._lose
        )
        source.subscribe(node, topic.topic, topic.type, self._connect, options)

    def _connect(self, peer: Peer) -> MessageHandler | None:
        name = self._topic.topic
        subject = f"{printable(peer.node)} on {name}"
        if not peer.verified or not any(matches_node(p, peer.node) for p in self._topic.publishers):
            self._refusals.report(subject, "the manifest does not name it as a publisher")
            return None
        if not self._output.learn_type(peer.info):
            self._refusals.report(subject, f"its type is {printable(peer.info.type)}")
            return None
        if peer.qos:
            self._output.offer(peer.node, peer.qos)
        publish, latched_by = self._output.publish, peer.node if peer.latching else None
        return (lambda message: publish(message, latched_by)) if latched_by else publish

    def _lose(self, peer: Peer) -> None:
        if peer.latching:
            self._output.clear_latched()


def open_published(
    manifest: CellManifest,
    outside: Transport,
    cell: CellConnection[Any],
    refusals: CellRefusals,
) -> None:
    """Pass on what the node in a cell publishes, and tell on /diagnostics what is refused."""
    outputs: dict[str, Output] = {}
    for topic in manifest.published:
        output = outside.advertise(manifest.node, topic.topic, topic.type)
        outputs[topic.topic] = output
        cell.apply(partial(TopicRelay(topic, output, refusals).open, node=GATEWAY_NODE))
    diagnostics = DIAGNOSTICS[outside.encoding]
    output = outputs.get(_DIAGNOSTICS_TOPIC) or outside.advertise(
        manifest.node, _DIAGNOSTICS_TOPIC, diagnostics.type
    )
    output.learn_type(diagnostics)
    refusals.publish(output, outside)
