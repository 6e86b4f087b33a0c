"""Requests to shut down the guard's nodes; the slave API of ROS 1 lets anybody send them."""

import logging

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable

log = logging.getLogger(__name__)


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
