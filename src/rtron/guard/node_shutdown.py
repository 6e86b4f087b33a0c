"""Requests to shut down the guard's nodes; the slave API of ROS 1 lets anybody send them."""

import logging

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import LiveTransport
from rtron.vocabulary import GUARD_NODE, SECOND

log = logging.getLogger(__name__)

_POLL_PERIOD = SECOND // 50
_GRACE = 8 * SECOND
"""A busy machine sends the stop late; the robot must be at rest before the node leaves."""


class ShutdownRefusal:
    """Refuses: a supervised guard cannot be ended over the network."""

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop
        self._log_throttle = LogThrottle()

    def handle(self, node: str, reason: str) -> None:
        """Log how to end the guard instead, once a second at most."""
        if self._log_throttle.allows(node, self._loop.now()):
            text = "%s is not shut down, end rtron guard itself: %s"
            log.warning(text, node, printable(reason))


class ShutdownSequence:
    """Shuts nodes down once the robot that they moved has stopped."""

    def __init__(self, coordinator: Coordinator, transport: LiveTransport, loop: EventLoop) -> None:
        self._coordinator = coordinator
        self._transport = transport
        self._loop = loop
        self._nodes_ending: set[str] = set()

    def handle(self, node: str, reason: str) -> None:
        """Stop the streams of a node, then remove it; the guard's own node ends the guard."""
        if node in self._nodes_ending:
            return
        self._nodes_ending.add(node)
        log.error("%s was shut down: %s", node, printable(reason))
        ends_guard = self._coordinator.shut_down_node(node, printable(reason))
        stopping_streams = [
            each for each in self._coordinator.streams if ends_guard or node in each.nodes
        ]
        if ends_guard:
            _stop_streams(stopping_streams)
        stops = [each.spec.stop for each in stopping_streams]
        longest = max((stop.within + stop.repeat for stop in stops), default=0) + _GRACE
        self._remove_when_stopped(node, stopping_streams, self._loop.now() + longest)

    def _remove_when_stopped(
        self, node: str, stopping_streams: list[GuardedStream], until: int
    ) -> None:
        now = self._loop.now()
        if now < until and any(
            each.stop_controller.deadline() is not None for each in stopping_streams
        ):
            self._loop.call_at(
                now + _POLL_PERIOD, lambda: self._remove_when_stopped(node, stopping_streams, until)
            )
            return
        self._transport.remove_node(node)
        if node == GUARD_NODE:
            self._loop.stop()


def _stop_streams(streams: list[GuardedStream]) -> None:
    for each in streams:
        each.brake("shutdown", f"{GUARD_NODE} was shut down")
        each.stop_controller.release_brake()
