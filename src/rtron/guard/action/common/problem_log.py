"""Problems with what nodes send to an action, logged at a limited rate for each node."""

import logging
from collections.abc import Callable

from rtron.errors import WireError
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.common.protocol import MessageHandler, Peer, Transport

log = logging.getLogger(__name__)

MAX_NAME_LENGTH = 128


class ProblemLog:
    """Logs what is wrong with messages; a node with many problems hides no other node's."""

    def __init__(self, action: str, transport: Transport) -> None:
        self._action = action
        self._transport = transport
        self._log_throttle = LogThrottle()

    def log(self, node: str, why: str) -> None:
        """Log a problem with a node."""
        name = node[:MAX_NAME_LENGTH]
        if self.allows("complaint", name):
            log.warning("%s: %s: %s", self._action, name, why)

    def allows(self, kind: str, name: str) -> bool:
        """Tell whether something may be logged of a node now."""
        return self._log_throttle.allows((kind, name), self._transport.now())

    def decoding_receiver(self, peer: Peer, take: Callable[[bytes], None]) -> MessageHandler:
        """Return what takes a node's messages, and drops those that cannot be read."""

        def receive(message: bytes) -> None:
            try:
                take(message)
            except WireError as error:
                self.log(peer.node, f"what it says cannot be read: {error}")

        return receive
