"""Latched goals: a publisher's last word comes again over each new connection, to act on it once.

Also the next guard must know it.
"""

import logging
from hashlib import blake2b

from rtron.guard.transport.transport import Receive
from rtron.guard.will import Will

log = logging.getLogger(__name__)

_MOST = 64


class Latched:
    """Knows the last goal of each latching publisher of a topic, this guard's and those before."""

    def __init__(self, topic: str, will: Will) -> None:
        self._topic = topic
        self._key = f"latched {topic}"
        self._will = will
        found = will.found(self._key)
        self._last: dict[str, str] = dict(found) if isinstance(found, dict) else {}

    def once(self, node: str, take: Receive) -> Receive:
        """Return what takes the messages of a new connection, its first only if it is new."""
        first = True

        def receive(message: bytes) -> None:
            nonlocal first
            digest = blake2b(message, digest_size=16).hexdigest()
            again, first = first and self._last.get(node) == digest, False
            if again:
                log.warning("%s: %s is connected again; its goal is old", self._topic, node)
                return
            self._remember(node, digest)
            take(message)

        return receive

    def _remember(self, node: str, digest: str) -> None:
        self._last.pop(node, None)
        self._last[node] = digest
        if len(self._last) > _MOST:
            self._last.pop(next(iter(self._last)))
        self._will.keep(self._key, self._last)
